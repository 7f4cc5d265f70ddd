#pragma once

#include <vector>

namespace clearway {

/// Numbers of a clock as seconds: those of 19 digits are taken for nanoseconds since 1970, of 16 for
/// microseconds, of 13 for milliseconds, as the largest of them says for all. Others stay: 14 digits are a
/// date, as 20261123071530, whose seconds are no milliseconds.
void make_seconds(std::vector<double>& times);

}  // namespace clearway
