#include "datasets/bags/mcap_records.hpp"

#include <unistd.h>

#include <algorithm>

namespace clearway::mcap {

Bytes File::read(std::uint64_t at, std::uint64_t count) {
  if (at > size_ || count > size_ - at) throw std::runtime_error("the file ends early");
  if (at < begin_ || at + count > begin_ + part_.size()) {
    constexpr std::uint64_t ahead = 1U << 14U;
    part_.resize(std::min(std::max(count, ahead), size_ - at));
    begin_ = at;
    for (std::size_t done = 0; done < part_.size();) {
      const ssize_t got =
          ::pread(descriptor_, part_.data() + done, part_.size() - done, static_cast<off_t>(at + done));
      if (got <= 0) throw std::runtime_error("the file cannot be read");
      done += static_cast<std::size_t>(got);
    }
  }
  return Bytes(part_).subspan(at - begin_, count);
}

}  // namespace clearway::mcap
