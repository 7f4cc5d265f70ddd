#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace clearway {

/// The time that a name without its end says: the number that it is (see make_seconds); that of a clock at
/// its end or beginning, as depth_1305031102.160 (ten digits before a point, or 13, 16 or 19 digits), or as
/// cloud_1305031102_160123456 (ten digits and nine of nanoseconds); Redwood's microseconds behind a
/// number, as 0000012-000000400000; ARKitScenes' seconds, as 47331606_74.512; else a date at its end, as
/// 2026-11-23_07-15-30.066, 20261123_071530 or 20261123071530066 (UTC is taken). Empty for another name.
std::optional<double> time_in_name(const std::string& stem);

/// Files by the times in their names; those without one are left out.
std::map<double, std::filesystem::path> files_by_time(const std::vector<std::filesystem::path>& files);

/// The file whose time is nearest; null: none is within `most_apart`, s.
const std::pair<const double, std::filesystem::path>* nearest_file(
    const std::map<double, std::filesystem::path>& files, double time, double most_apart);

/// Seconds since 1970 of a date, UTC; empty for one that is none.
std::optional<double> seconds_of_date(int year, int month, int day, int hour, int minute, int second);

}  // namespace clearway
