// The errors every stage throws. Each message is one sentence that names the thing and the remedy.
#pragma once

#include <stdexcept>
#include <string>

namespace mesoshell {

// An argument that cannot be meant: out of range, not finite, of the wrong size.
struct InvalidArgument : std::invalid_argument {
    using std::invalid_argument::invalid_argument;
};

// A well-formed input that Mesoshell cannot use: a file that is no map, a mesh that cannot carry a shell.
struct Error : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// The caller's progress callback answered false.
struct Cancelled : Error {
    Cancelled() : Error("cancelled") {}
};

// The file system refused; `code` is errno.
struct FileError : std::runtime_error {
    FileError(int code, std::string path) : std::runtime_error(path), code(code), path(std::move(path)) {}
    int code;
    std::string path;
};

}  // namespace mesoshell
