// Choices by name: enumerations as strings.
#pragma once

#include <algorithm>
#include <string>

#include "errors.h"
#include "mesoshell/error.h"

namespace mesoshell::python {

template <typename Choice>
struct Named {
    const char* name;
    Choice choice;
};

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

}  // namespace mesoshell::python
