// All or nothing: a file that takes the place of another only when it is whole and on the disk.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>

#include <OpenEXR/ImfIO.h>

namespace mesoshell {

// What OpenEXR writes to, beside the target; removed unless it was kept. A killed process leaves its file; the next save to
// the same target removes it. OpenEXR writes its last bytes in a destructor, which cannot say that the disk is full, so the
// first failure of all is remembered here.
class TemporaryFile : public Imf::OStream {
public:
    // Throws FileError with the target's path.
    explicit TemporaryFile(const std::string& target);
    ~TemporaryFile() override;
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    void write(const char bytes[], int count) override;
    std::uint64_t tellp() override;
    void seekp(std::uint64_t position) override;

    // The file takes the target's place. Throws FileError if anything was not written.
    void keep();

private:
    void check(bool done);

    std::string target_;
    std::string path_;
    std::FILE* file_ = nullptr;
    int code_ = 0;
};

}  // namespace mesoshell
