#include "apps/console/failure.hpp"

#include <algorithm>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <typeinfo>

#include "mapping/files/map_file.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/pose_goals.hpp"

namespace clearway {
namespace {

constexpr const char* out_of_memory =
    "out of memory: expected input that fits into this machine's memory, such as coarser voxels, smaller "
    "extents or smaller files";

/// A sentence of ours ends in the place where it was made; a text that it repeats may have any length.
std::string one_line(const std::string& sentence) {
  constexpr std::size_t longest = 2000;
  const std::string line = plain(sentence);
  if (line.size() <= longest) return line;
  std::size_t cut = longest;
  while ((static_cast<unsigned char>(line[cut]) & 0xc0U) == 0x80U) --cut;  // not within a character
  return line.substr(0, cut) + "…";
}

/// Thrown by name, not through a class of some library that derives from it.
template <class Type>
bool is_exactly(const std::exception& error) {
  return typeid(error) == typeid(Type);
}

}  // namespace

Failure failure_of(const std::exception_ptr& error) {
  try {
    std::rethrow_exception(error);
  } catch (const DamagedFile& damaged) {
    return {one_line(damaged.what()), exit_damaged};
  } catch (const std::bad_alloc&) {
    return {out_of_memory};
  } catch (const std::length_error&) {
    return {out_of_memory};
  } catch (const std::filesystem::filesystem_error& refused) {
    return {one_line("'" + refused.path1().string() + "' cannot be used: " + refused.code().message())};
  } catch (const std::exception& other) {
    if (is_exactly<std::invalid_argument>(other) || is_exactly<std::runtime_error>(other) ||
        is_exactly<UnreachablePose>(other))
      return {one_line(other.what())};
    return {"a library that the program uses could not handle its input"};
  } catch (...) {
    return {"a library that the program uses could not handle its input"};
  }
}

}  // namespace clearway
