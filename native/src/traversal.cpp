#include "mesoshell/traversal.h"

#include <array>

#include "mesoshell/error.h"

namespace mesoshell {
namespace {

struct Named {
    Traversal traversal;
    std::string_view name;
};

constexpr std::array<Named, 6> named_traversals{{
    {Traversal::gdm, "gdm"},
    {Traversal::sdf, "sdf"},
    {Traversal::refined, "refined"},
    {Traversal::march, "march"},
    {Traversal::slices, "slices"},
    {Traversal::exact, "exact"},
}};

std::string choices()
{
    std::string list;
    for (std::size_t i = 0; i < named_traversals.size(); ++i) {
        list += (i == 0 ? "" : i + 1 == named_traversals.size() ? " or " : ", ") + std::string(named_traversals[i].name);
    }
    return list;
}

}  // namespace

Traversal traversal_named(std::string_view name)
{
    for (const Named& named : named_traversals) {
        if (named.name == name) {
            return named.traversal;
        }
    }
    throw InvalidArgument("traversal '" + std::string(name) + "' does not exist; choose " + choices());
}

void check_traversal(int traversal)
{
    for (const Named& named : named_traversals) {
        if (static_cast<int>(named.traversal) == traversal) {
            return;
        }
    }
    throw InvalidArgument("traversal " + std::to_string(traversal) + " does not exist; choose " + choices());
}

std::vector<std::string> traversal_names()
{
    std::vector<std::string> names;
    for (const Named& named : named_traversals) {
        names.emplace_back(named.name);
    }
    return names;
}

}  // namespace mesoshell
