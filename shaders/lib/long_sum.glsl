// Sums of vectors to about twice single precision: a value and what rounding took out of it (Dekker 1971, Knuth 1969).
//
// A compiler that rearranges sums would find every rest to be zero: what must stay in its order is `precise`.
#ifndef MESOSHELL_LIB_LONG_SUM
#define MESOSHELL_LIB_LONG_SUM

struct LongSum {
    vec3 value;
    vec3 rest;
};

// What a + b loses when rounded to `sum`.
vec3 sum_rest(vec3 a, vec3 b, vec3 sum)
{
    precise vec3 seen_b = sum - a;
    precise vec3 rest = (a - (sum - seen_b)) + (b - seen_b);
    return rest;
}

// The upper twelve bits, so that products of halves are exact.
vec3 upper_half(vec3 a)
{
    precise vec3 scaled = a * 4097.0f;
    precise vec3 upper = scaled - (scaled - a);
    return upper;
}

// What a * b loses when rounded to `product`.
vec3 product_rest(vec3 a, vec3 b, vec3 product)
{
    precise vec3 a_upper = upper_half(a);
    precise vec3 b_upper = upper_half(b);
    precise vec3 a_lower = a - a_upper;
    precise vec3 b_lower = b - b_upper;
    precise vec3 rest = a_lower * b_lower - (((product - a_upper * b_upper) - a_lower * b_upper) - a_upper * b_lower);
    return rest;
}

// a - b
LongSum long_difference(vec3 a, vec3 b)
{
    precise vec3 value = a - b;
    LongSum result;
    result.value = value;
    result.rest = sum_rest(a, -b, value);
    return result;
}

// sum + a * factor
LongSum add_scaled(LongSum sum, LongSum a, float factor)
{
    vec3 factors = vec3(factor);
    precise vec3 product = a.value * factors;
    precise vec3 value = sum.value + product;
    LongSum result;
    result.value = value;
    result.rest = sum.rest + a.rest * factor + product_rest(a.value, factors, product) + sum_rest(sum.value, product, value);
    return result;
}

#endif
