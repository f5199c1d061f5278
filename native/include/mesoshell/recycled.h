// Memory that goes from one generation of arrays to the next: an animated shell has arrays of the same sizes every frame,
// and mapping and clearing their pages anew would cost more than computing them.
#pragma once

#include <map>
#include <memory>
#include <mutex>

#include "mesoshell/uninitialized.h"

namespace mesoshell {

// Freed blocks, one of each size at most. Freed itself with the last array that uses it.
class BlockPool {
public:
    BlockPool() = default;
    BlockPool(const BlockPool&) = delete;
    BlockPool& operator=(const BlockPool&) = delete;
    ~BlockPool()
    {
        for (const auto& [size, block] : idle_) {
            UninitializedAllocator<char>().deallocate(block, size);
        }
    }

    void* take(std::size_t bytes)
    {
        {
            const std::lock_guard guard(lock_);
            const auto found = idle_.find(bytes);
            if (found != idle_.end()) {
                void* block = found->second;
                idle_.erase(found);
                return block;
            }
        }
        return UninitializedAllocator<char>().allocate(bytes);
    }
    void give_back(void* block, std::size_t bytes)
    {
        {
            const std::lock_guard guard(lock_);
            if (idle_.try_emplace(bytes, static_cast<char*>(block)).second) {
                return;
            }
        }
        UninitializedAllocator<char>().deallocate(static_cast<char*>(block), bytes);
    }

private:
    std::mutex lock_;
    std::map<std::size_t, char*> idle_;
};

// As UninitializedAllocator, from a pool where it has one. A vector gets its pool when it is made.
template <typename Value>
struct RecycledAllocator {
    using value_type = Value;
    using propagate_on_container_move_assignment = std::true_type;
    using propagate_on_container_copy_assignment = std::true_type;
    using propagate_on_container_swap = std::true_type;
    RecycledAllocator() = default;
    explicit RecycledAllocator(std::shared_ptr<BlockPool> blocks) : pool(std::move(blocks)) {}
    template <typename Other>
    explicit RecycledAllocator(const RecycledAllocator<Other>& other) : pool(other.pool)
    {
    }

    Value* allocate(std::size_t count)
    {
        const std::size_t bytes = count * sizeof(Value);
        return static_cast<Value*>(pool ? pool->take(bytes) : UninitializedAllocator<char>().allocate(bytes));
    }
    void deallocate(Value* memory, std::size_t count)
    {
        if (pool) {
            pool->give_back(memory, count * sizeof(Value));
        } else {
            UninitializedAllocator<Value>().deallocate(memory, count);
        }
    }

    template <typename Other>
    void construct(Other*)
    {
    }
    template <typename Other, typename First, typename... Rest>
    void construct(Other* place, First&& first, Rest&&... rest)
    {
        ::new (static_cast<void*>(place)) Other(std::forward<First>(first), std::forward<Rest>(rest)...);
    }

    bool operator==(const RecycledAllocator& other) const { return pool == other.pool; }

    std::shared_ptr<BlockPool> pool;
};

template <typename Value>
using RecycledVector = std::vector<Value, RecycledAllocator<Value>>;

}  // namespace mesoshell
