// Any bytes as a map: it is read, or refused in a sentence. Anything else, also gigabytes or seconds, is a finding.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>

#include <OpenEXR/IexBaseExc.h>

#include "mesoshell/error.h"
#include "store_read.h"

namespace {

class Bytes : public Imf::IStream {
public:
    Bytes(const std::uint8_t* data, std::size_t size) : IStream("bytes.exr"), data_(data), size_(size) {}

    bool read(char to[], int count) override
    {
        if (count < 0 || static_cast<std::uint64_t>(count) > size_ - std::min<std::uint64_t>(size_, position_)) {
            throw Iex::InputExc("early end of file");
        }
        std::memcpy(to, data_ + position_, static_cast<std::size_t>(count));
        position_ += static_cast<std::uint64_t>(count);
        return position_ < size_;
    }
    std::uint64_t tellg() override { return position_; }
    void seekg(std::uint64_t position) override { position_ = position; }
    void clear() override {}

private:
    const std::uint8_t* data_;
    std::uint64_t size_;
    std::uint64_t position_ = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    Bytes bytes(data, size);
    try {
        const mesoshell::Map map = mesoshell::store::read_map("bytes.exr", bytes, size);
        if (map.weights.empty() || map.eigenmaps.empty()) {
            std::abort();
        }
    } catch (const mesoshell::Error& refusal) {
        if (std::string(refusal.what()).find("bytes.exr") == std::string::npos) {
            std::abort();
        }
    }
    return 0;
}
