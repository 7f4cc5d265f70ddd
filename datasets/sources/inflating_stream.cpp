#include "datasets/sources/inflating_stream.hpp"

#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>

namespace clearway {

InflatingStream::InflatingStream(int descriptor)
    : descriptor_(descriptor), inflater_(std::make_unique<z_stream>()) {
  // 16 + 15: gzip framing, largest window; inflate then checks CRC32 and size of each member itself.
  if (inflateInit2(inflater_.get(), 16 + MAX_WBITS) != Z_OK) throw std::bad_alloc();
  fill_raw();
  compressed_ = raw_end_ >= 1 && raw_[0] == 0x1f && (raw_end_ == 1 || raw_[1] == 0x8b);
  if (compressed_) {
    inflater_->next_in = raw_.data();
    inflater_->avail_in = static_cast<unsigned>(raw_end_);
    member_open_ = true;
  }
}

InflatingStream::~InflatingStream() { inflateEnd(inflater_.get()); }

uint64_t InflatingStream::file_offset() const {
  return bytes_read_ - (compressed_ ? inflater_->avail_in : raw_end_ - raw_begin_);
}

void InflatingStream::fail(const std::string& reason) {
  damage_ = reason;
  throw DamagedStream(reason);
}

bool InflatingStream::fill_raw() {
  ssize_t got;
  do {
    got = ::read(descriptor_, raw_.data(), raw_.size());
  } while (got < 0 && errno == EINTR);
  if (got < 0) fail(std::string("the file cannot be read: ") + std::strerror(errno));
  raw_begin_ = 0;
  raw_end_ = static_cast<size_t>(got);
  bytes_read_ += raw_end_;
  return got > 0;
}

// Called with the plain buffer empty; leaves at least one byte in it, or `finished_`.
void InflatingStream::inflate_more() {
  inflater_->next_out = plain_.data();
  inflater_->avail_out = static_cast<unsigned>(plain_.size());
  plain_begin_ = plain_end_ = 0;
  while (inflater_->avail_out == plain_.size() && !finished_) {
    if (inflater_->avail_in == 0) {
      if (!fill_raw()) {
        if (member_open_) fail("the compressed data is cut off");
        finished_ = true;
        break;
      }
      inflater_->next_in = raw_.data();
      inflater_->avail_in = static_cast<unsigned>(raw_end_);
    }
    if (!member_open_) {
      if (*inflater_->next_in != 0x1f) fail("other bytes follow the compressed data");
      inflateReset(inflater_.get());
      member_open_ = true;
    }
    const int status = inflate(inflater_.get(), Z_NO_FLUSH);
    if (status == Z_STREAM_END) {
      member_open_ = false;
    } else if (status != Z_OK && status != Z_BUF_ERROR) {
      fail(std::string("the compressed data does not pass its own check (") +
           (inflater_->msg ? inflater_->msg : "zlib error") + ")");
    }
  }
  plain_end_ = plain_.size() - inflater_->avail_out;
}

bool InflatingStream::at_end() {
  if (compressed_) {
    if (plain_begin_ == plain_end_ && !finished_) inflate_more();
    return plain_begin_ == plain_end_;
  }
  if (raw_begin_ == raw_end_ && !finished_) finished_ = !fill_raw();
  return raw_begin_ == raw_end_;
}

size_t InflatingStream::Read(void* target, size_t size) {
  auto& buffer = compressed_ ? plain_ : raw_;
  size_t& begin = compressed_ ? plain_begin_ : raw_begin_;
  const size_t& end = compressed_ ? plain_end_ : raw_end_;
  size_t done = 0;
  while (done < size && !at_end()) {
    const size_t part = std::min(size - done, end - begin);
    std::memcpy(static_cast<char*>(target) + done, buffer.data() + begin, part);
    begin += part;
    done += part;
  }
  return done;
}

}  // namespace clearway
