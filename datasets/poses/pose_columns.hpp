#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace clearway {

/// Where a time and a pose stand in the lines of a text file, as its head says; by default time, x, y, z, qx,
/// qy, qz and qw alone.
struct PoseColumns {
  using Places = std::array<std::size_t, 8>;  ///< of time, x, y, z, qx, qy, qz and qw, columns from 0

  bool has_head = false;
  bool is_w_first = false;
  std::size_t count = 0;               ///< of columns, where there are more than a time and a pose; 0: not
  std::size_t count_with_blanks = 0;   ///< the same of a head without commas, whose names may hold blanks
  std::size_t before_nanoseconds = 0;  ///< columns before those, of a head that names them; 0: it does not
  std::optional<Places> by_name;       ///< where they stand in another order

  /// What is expected of a line, as users read it.
  std::string expected() const;
};

/// What stands in a line apart by blanks or commas.
std::vector<std::string> cells_of(std::string line);

/// Of a line such as "# time tx ty tz qw qx qy qz"; empty when it is no head: it names no w among four
/// columns or more. @throws std::invalid_argument with what was expected of a head
std::optional<PoseColumns> columns_of_head(const std::string& line);

/// The words of a line in the usual order, except that qw may come first.
struct PoseWords {
  std::vector<std::string> words;     ///< more or fewer than eight: the line is another
  std::optional<double> nanoseconds;  ///< as seconds, to be added to the time; empty: expected and not there
};
PoseWords pose_words(std::vector<std::string> words, const PoseColumns& columns);

}  // namespace clearway
