// Which items name a thing: the corners at a vertex, the prisms at a vertex, the entries of a group.
#pragma once

#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace mesoshell {

class Incidence {
public:
    // Item i names thing `names[i]`; names are below `count`.
    template <typename Integer>
    Incidence(std::span<const Integer> names, std::size_t count) : firsts_(count + 1, 0), items_(names.size())
    {
        for (const Integer name : names) {
            firsts_[static_cast<std::size_t>(name) + 1] += 1;
        }
        std::partial_sum(firsts_.begin(), firsts_.end(), firsts_.begin());
        std::vector<std::uint32_t> next(firsts_.begin(), firsts_.end() - 1);
        for (std::size_t i = 0; i < names.size(); ++i) {
            items_[next[static_cast<std::size_t>(names[i])]++] = static_cast<std::uint32_t>(i);
        }
    }

    // Ascending.
    std::span<const std::uint32_t> of(std::size_t thing) const
    {
        return std::span(items_).subspan(firsts_[thing], firsts_[thing + 1] - firsts_[thing]);
    }

private:
    std::vector<std::uint32_t> firsts_;
    std::vector<std::uint32_t> items_;
};

}  // namespace mesoshell
