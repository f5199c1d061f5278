// Memory for arrays that are written whole before they are read.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>
#include <vector>

#include <sys/mman.h>

namespace mesoshell {

// Leaves values as they are when a vector grows, and asks for huge pages where they pay: a raw GDM is hundreds of megabytes, which
// would cost as much to clear and to map in small pages as to bake.
template <typename Value>
struct UninitializedAllocator {
    using value_type = Value;
    UninitializedAllocator() = default;
    template <typename Other>
    explicit UninitializedAllocator(const UninitializedAllocator<Other>&)
    {
    }

    Value* allocate(std::size_t count)
    {
        constexpr std::size_t huge_page = std::size_t(2) << 20;
        const std::size_t bytes = count * sizeof(Value);
        const std::size_t alignment = bytes >= 8 * huge_page ? huge_page : 64;
        void* memory = std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
        if (memory == nullptr) {
            throw std::bad_alloc();
        }
        if (alignment == huge_page) {
            madvise(memory, bytes, MADV_HUGEPAGE);  // a hint; refused where there are none
        }
        return static_cast<Value*>(memory);
    }
    void deallocate(Value* memory, std::size_t) { std::free(memory); }

    template <typename Other>
    void construct(Other*)
    {
    }
    template <typename Other, typename First, typename... Rest>
    void construct(Other* place, First&& first, Rest&&... rest)
    {
        ::new (static_cast<void*>(place)) Other(std::forward<First>(first), std::forward<Rest>(rest)...);
    }

    bool operator==(const UninitializedAllocator&) const { return true; }
};

template <typename Value>
using UninitializedVector = std::vector<Value, UninitializedAllocator<Value>>;

}  // namespace mesoshell
