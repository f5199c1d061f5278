#include "temporary_file.h"

#include <atomic>
#include <cerrno>
#include <filesystem>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "mesoshell/error.h"

namespace mesoshell {
namespace {

constexpr char infix[] = ".part-";

// Removes what killed savers left beside a target: whoever still writes holds a lock, which dies with its process.
void remove_leftovers(const std::filesystem::path& target)
{
    const std::string prefix = target.filename().string() + infix;
    const std::filesystem::path folder = target.has_parent_path() ? target.parent_path() : std::filesystem::path(".");
    std::error_code problem;
    std::filesystem::directory_iterator entry(folder, problem);
    for (; !problem && entry != std::filesystem::directory_iterator(); entry.increment(problem)) {
        if (entry->path().filename().string().rfind(prefix, 0) != 0) {
            continue;
        }
        const int file = open(entry->path().c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
        if (file >= 0) {
            if (flock(file, LOCK_EX | LOCK_NB) == 0) {
                unlink(entry->path().c_str());
            }
            close(file);
        }
    }
}

// Whether the file, locked from here on, still has its name: else another saver took it for a leftover.
bool lock(std::FILE* file)
{
    struct stat status{};
    return flock(fileno(file), LOCK_EX) != 0 || fstat(fileno(file), &status) != 0 || status.st_nlink > 0;
}

}  // namespace

TemporaryFile::TemporaryFile(const std::string& target) : OStream(target.c_str()), target_(target)
{
    // A link stays one, and what it points to is replaced.
    std::error_code problem;
    const std::filesystem::path resolved = std::filesystem::canonical(target, problem);
    if (!problem) {
        target_ = resolved.string();
    }
    remove_leftovers(target_);
    // A name of its own for every save, so that two to one path never share a file.
    static std::atomic<unsigned> saves = 0;
    for (int attempt = 0; attempt < 100 && file_ == nullptr; ++attempt) {
        path_ = target_ + infix + std::to_string(getpid()) + "-" + std::to_string(++saves);
        file_ = std::fopen(path_.c_str(), "wbxe");
        if (file_ == nullptr && errno != EEXIST) {
            break;
        }
        if (file_ != nullptr && !lock(file_)) {
            std::fclose(file_);
            file_ = nullptr;
            errno = EEXIST;
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
    // Closing ends the lock, so the file gets its name before.
    check(std::rename(path_.c_str(), target_.c_str()) == 0);
    path_.clear();
    const bool closed = std::fclose(file_) == 0;
    file_ = nullptr;
    check(closed);
}

void TemporaryFile::check(bool done)
{
    if (!done && code_ == 0) {
        code_ = errno != 0 ? errno : EIO;
    }
    if (code_ != 0) {
        throw FileError(code_, fileName());
    }
}

}  // namespace mesoshell
