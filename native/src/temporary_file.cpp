#include "temporary_file.h"

#include <atomic>
#include <cerrno>
#include <filesystem>

#include <unistd.h>

#include "mesoshell/error.h"

namespace mesoshell {

TemporaryFile::TemporaryFile(const std::string& target) : OStream(target.c_str()), target_(target)
{
    // A link stays one, and what it points to is replaced.
    std::error_code problem;
    const std::filesystem::path resolved = std::filesystem::canonical(target, problem);
    if (!problem) {
        target_ = resolved.string();
    }
    // A name of its own for every save, so that two to one path never share a file.
    static std::atomic<unsigned> saves = 0;
    for (int attempt = 0; attempt < 100 && file_ == nullptr; ++attempt) {
        path_ = target_ + ".part-" + std::to_string(getpid()) + "-" + std::to_string(++saves);
        file_ = std::fopen(path_.c_str(), "wbxe");
        if (file_ == nullptr && errno != EEXIST) {
            break;
        }
    }
    if (file_ == nullptr) {
        path_.clear();
        throw FileError(errno != 0 ? errno : EIO, target);
    }
}

TemporaryFile::~TemporaryFile()
{
    if (file_ != nullptr) {
        std::fclose(file_);
    }
    if (!path_.empty()) {
        unlink(path_.c_str());
    }
}

void TemporaryFile::write(const char bytes[], int count)
{
    check(std::fwrite(bytes, 1, static_cast<std::size_t>(count), file_) == static_cast<std::size_t>(count));
}

std::uint64_t TemporaryFile::tellp()
{
    return static_cast<std::uint64_t>(ftello(file_));
}

void TemporaryFile::seekp(std::uint64_t position)
{
    check(fseeko(file_, static_cast<off_t>(position), SEEK_SET) == 0);
}

void TemporaryFile::keep()
{
    check(std::fflush(file_) == 0 && fsync(fileno(file_)) == 0);
    const bool closed = std::fclose(file_) == 0;
    file_ = nullptr;
    check(closed && std::rename(path_.c_str(), target_.c_str()) == 0);
    path_.clear();
}

void TemporaryFile::check(bool done)
{
    if (!done && code_ == 0) {
        code_ = errno != 0 ? errno : EIO;
    }
    if (code_ != 0) {
        throw FileError(code_, target_);
    }
}

}  // namespace mesoshell
