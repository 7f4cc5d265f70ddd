#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string>
#include <vector>

namespace clearway {

/// How many files of each kind are mutated: CLEARWAY_MUTATIONS, else `otherwise`.
inline int mutations(int otherwise) {
  const char* given = std::getenv("CLEARWAY_MUTATIONS");
  return given ? std::atoi(given) : otherwise;
}

/// The bytes with one to four changes: bytes or numbers changed, cut out, doubled, put in, or the end cut
/// off.
inline std::string mutated(const std::string& whole, std::mt19937& random) {
  static const std::vector<std::string> words = {"[",       "{",    "1e308", "-1",   "99999999999", "\"",
                                                 "&a *a",   "\xff", "nan",   "\n",   ": ",          "- ",
                                                 "\x1b[2J", "0",    "</",    "&lt;", "<a>",         "%n"};
  static const std::vector<std::string> numbers = {"99999999999", "-1",   "4294967295", "nan",  "1e39",
                                                   "0",           "-inf", "1e-320",     "1e308"};
  std::string bytes = whole;
  for (unsigned changes = 1 + random() % 4; changes > 0 && !bytes.empty(); --changes) {
    const std::size_t at = random() % bytes.size(),
                      size = 1 + random() % std::min<std::size_t>(40, bytes.size());
    switch (random() % 8) {
      case 0:
        bytes[at] = static_cast<char>(random());
        break;
      case 1:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
        break;
      case 2:
        bytes.erase(at, size);
        break;
      case 3:
        bytes.insert(at, bytes.substr(random() % bytes.size(), size));
        break;
      case 4:
        bytes.resize(at);
        break;
      case 5: {  // another number in place of one
        const std::size_t begin = bytes.find_first_of("0123456789", at);
        if (begin == std::string::npos) break;
        const std::size_t end = std::min(bytes.find_first_not_of("0123456789.", begin), bytes.size());
        bytes.replace(begin, end - begin, numbers[random() % numbers.size()]);
        break;
      }
      case 6: {  // four bytes of a binary file
        static constexpr std::array<std::uint32_t, 5> values = {0xFFFFFFFFU, 0x7FFFFFFFU, 0U, 0x7F800000U,
                                                                0x01000000U};
        if (at + 4 <= bytes.size()) std::memcpy(&bytes[at], &values[random() % values.size()], 4);
        break;
      }
      default:
        bytes.insert(at, words[random() % words.size()]);
    }
  }
  return bytes;
}

}  // namespace clearway
