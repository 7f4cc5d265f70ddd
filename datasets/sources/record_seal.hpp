#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace clearway {

/// What a record of our own recordings says of itself, checked by a CRC32 of its own: which it is, when it
/// was taken and how many bytes it has. Each record is a gzip member, which ends with the CRC32 of its
/// content; the seal is in the member's extra field "CW" (RFC 1952, 2.3.1.1), which other readers skip. So
/// every gzip and every MRPT reads the file, and we find a damaged record, and the next whole one behind it.
struct RecordSeal {
  static constexpr std::size_t header_bytes = 40;  ///< of a sealed member, before its compressed content

  std::uint32_t size = 0;   ///< bytes of the whole member
  std::uint32_t index = 0;  ///< 0, 1, 2, ...; of the end: how many records there are
  double time = 0;          ///< s since 1970
  bool is_end = false;      ///< the last member, which is empty: without it, the recording is cut off
};

/// The member: header with its seal, compressed content, checksum. `size` is found out.
std::string sealed_record(std::string_view content, RecordSeal seal);

/// The seal of the member that `bytes` begin with; none when they begin with no sealed member.
std::optional<RecordSeal> seal_of(std::string_view bytes);

/// The content of a whole member; none when it does not pass its checksum.
std::optional<std::string> unsealed(std::string_view member);

}  // namespace clearway
