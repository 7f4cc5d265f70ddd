#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace clearway {

/// Numbers of a clock as seconds: those of 19 digits are taken for nanoseconds since 1970, of 16 for
/// microseconds, of 13 for milliseconds, as the largest of them says for all. Others stay: 14 digits are a
/// date, as 20261123071530, whose seconds are no milliseconds.
void make_seconds(std::vector<double>& times);

constexpr double clock_begins = 1e9;  ///< s since 1970, which no number of a picture reaches

/// Where make_seconds makes smaller numbers of all: the first that is of a clock in larger units.
/// @param times rising, at least one
std::optional<std::size_t> of_another_unit(const std::vector<double>& times);

/// Whether whole numbers would be years apart as seconds: they count from a start in a finer unit. Those of a
/// clock may span years: as seconds, each would be months from the next.
/// @param times rising
bool count_from_zero(const std::vector<double>& times);

/// Of such: nanoseconds where they are a millisecond or more apart as such, else microseconds (which a second
/// and more apart are taken for nanoseconds).
std::vector<double> finer_than_seconds(std::vector<double> times);

}  // namespace clearway
