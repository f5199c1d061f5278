// The names of layouts and precisions, and other choices by name.
#pragma once

#include <algorithm>
#include <string>

#include "errors.h"
#include "mesoshell/compress.h"

namespace mesoshell::python {

template <typename Choice>
struct Named {
    const char* name;
    Choice choice;
};

inline constexpr Named<Precision> precisions[] = {{"byte", Precision::byte}, {"half", Precision::half}, {"float", Precision::single}};
inline constexpr Named<Layout> layouts[] = {{"paper", Layout::paper}, {"share", Layout::share}, {"nodes", Layout::nodes}, {"auto", Layout::automatic}};

template <typename Choice, std::size_t count>
PyObject* name_of(const Named<Choice> (&named)[count], Choice choice)
{
    const auto* found = std::find_if(named, named + count, [&](const auto& entry) { return entry.choice == choice; });
    return PyUnicode_FromString(found->name);
}

template <typename Choice, std::size_t count>
Choice choice_of(const Named<Choice> (&named)[count], const std::string& what, const std::string& name)
{
    const auto* found = std::find_if(named, named + count, [&](const auto& entry) { return entry.name == name; });
    if (found == named + count) {
        std::string known;
        for (std::size_t i = 0; i < count; ++i) {
            known += std::string(i == 0 ? "" : i + 1 == count ? " or " : ", ") + named[i].name;
        }
        throw InvalidArgument(what + " '" + name + "' does not exist; choose " + known);
    }
    return found->choice;
}

// The file system's own spelling of a path argument; throws PythonError.
std::string path_argument(PyObject* object);

}  // namespace mesoshell::python
