// What several tests share: refusals that must name their cause, and reproducible random numbers.
#pragma once

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <random>
#include <string>

#include <glm/glm.hpp>
#include <gtest/gtest.h>

namespace mesoshell {

// The call throws a Refusal, and its sentence has every one of the words.
template <typename Refusal, typename Call>
void expect_refusal(const Call& call, std::initializer_list<const char*> words)
{
    try {
        call();
    } catch (const Refusal& refusal) {
        const std::string sentence = refusal.what();
        for (const char* word : words) {
            EXPECT_NE(sentence.find(word), std::string::npos) << "'" << word << "' is not in: " << sentence;
        }
        return;
    } catch (const std::exception& other) {
        ADD_FAILURE() << "refused with another exception: " << other.what();
        return;
    }
    ADD_FAILURE() << "accepted; the refusal should have said '" << *words.begin() << "'";
}

// The same numbers on every machine, which the distributions of <random> do not promise.
class Random {
public:
    explicit Random(std::uint32_t seed) : engine_(seed) {}
    double uniform(double low, double high) { return low + (high - low) * (engine_() * 0x1p-32); }
    int below(int count) { return static_cast<int>(uniform(0.0, count)); }
    glm::dvec3 in_box(const glm::dvec3& low, const glm::dvec3& high)
    {
        const double x = uniform(low.x, high.x);
        const double y = uniform(low.y, high.y);
        return {x, y, uniform(low.z, high.z)};
    }
    // Uniform on the sphere.
    glm::dvec3 direction()
    {
        const double z = uniform(-1.0, 1.0);
        const double azimuth = uniform(0.0, 6.283185307179586);
        const double across = std::sqrt(1.0 - z * z);
        return {across * std::cos(azimuth), across * std::sin(azimuth), z};
    }

private:
    std::mt19937 engine_;
};

}  // namespace mesoshell
