#include "datasets/pictures/picture_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include "datasets/pictures/name_time.hpp"
#include "datasets/pictures/picture_times.hpp"
#include "datasets/sources/finite_number.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

constexpr double least_clock = 1e9;  ///< s since 1970, which no number of a picture reaches

bool is_numeral(char c) { return c >= '0' && c <= '9'; }

/// The runs of digits in a name, each without the zeros before it.
std::vector<std::string> digit_runs(const std::string& name) {
  std::vector<std::string> runs;
  for (std::size_t at = 0; at < name.size(); ++at) {
    if (!is_numeral(name[at])) continue;
    if (at == 0 || !is_numeral(name[at - 1])) runs.emplace_back();
    if (runs.back() == "0") runs.back().clear();
    runs.back() += name[at];
  }
  return runs;
}

/// Redwood's NUMBER-MICROSECONDS: the number alone.
std::string without_microseconds(const std::string& stem) {
  const std::size_t dash = stem.find('-');
  const bool is_redwood =
      dash != std::string::npos && dash > 0 && stem.size() == dash + 13 &&
      std::all_of(stem.begin(), stem.end(), [](char c) { return is_numeral(c) || c == '-'; });
  return is_redwood ? stem.substr(0, dash) : stem;
}

std::set<std::string> all_at(const std::vector<std::vector<std::string>>& runs, std::size_t place) {
  std::set<std::string> numbers;
  for (const auto& of_one : runs) numbers.insert(of_one[place]);
  return numbers;
}

/// Whether one set has all of the other when `added` is added to the poses'.
bool fit(const std::set<std::size_t>& pictures, const std::set<std::size_t>& poses, long added) {
  std::set<std::size_t> moved;
  for (const std::size_t pose : poses)
    moved.insert(static_cast<std::size_t>(static_cast<long>(pose) + added));
  return std::includes(pictures.begin(), pictures.end(), moved.begin(), moved.end()) ||
         std::includes(moved.begin(), moved.end(), pictures.begin(), pictures.end());
}

}  // namespace

std::map<fs::path, std::size_t> numbers_in_names(const std::vector<fs::path>& pictures) {
  std::vector<std::vector<std::string>> runs;
  for (const fs::path& picture : pictures) {
    const std::string name = without_microseconds(picture.stem().string());
    const double time = time_in_name(name).value_or(0.0);
    runs.push_back(digit_runs(name));
    const bool is_clock = time >= least_clock || time != std::floor(time);
    if (is_clock || runs.back().size() != runs.front().size()) return {};
  }
  std::optional<std::size_t> chosen;
  for (std::size_t place = 0; !runs.empty() && place < runs.front().size(); ++place) {
    const std::size_t different = all_at(runs, place).size();
    if (different == 1 && pictures.size() > 1) continue;
    if (chosen || different != pictures.size()) return {};
    chosen = place;
  }
  if (!chosen) return {};
  std::map<fs::path, std::size_t> numbers;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const double number = finite_number(runs[i][*chosen]).value_or(least_clock);
    if (number >= least_clock) return {};
    numbers[pictures[i]] = static_cast<std::size_t>(number);
  }
  return numbers;
}

long numbers_apart(const std::set<std::size_t>& pictures, const std::set<std::size_t>& poses) {
  const long first_picture = static_cast<long>(*pictures.begin()),
             first_pose = static_cast<long>(*poses.begin());
  const long apart = first_picture - first_pose;
  const bool may_begin_elsewhere =
      (first_picture == 0 && first_pose == 1) || (first_picture == 1 && first_pose == 0);
  if (pictures.size() == poses.size()) {
    const bool have_none_in_common =
        *pictures.rbegin() < *poses.begin() || *poses.rbegin() < *pictures.begin();
    if ((apart == 0 || may_begin_elsewhere || have_none_in_common) && fit(pictures, poses, apart))
      return apart;
    throw std::invalid_argument(
        "numbers that are not those in the pictures' names, nor all of them beyond these and higher or lower "
        "by the same");
  }
  const bool as_they_are = fit(pictures, poses, 0),
             moved = may_begin_elsewhere && fit(pictures, poses, apart);
  if (as_they_are && moved && first_pose == 0)
    throw std::invalid_argument(
        "numbers from 0, and the pictures numbers from 1, so that each may belong to the picture of the same "
        "number or to the next one");
  if (as_they_are) return 0;
  if (moved) return apart;
  throw std::invalid_argument("numbers that are not those in the pictures' names");
}

bool overlap_alike(const std::set<std::size_t>& pictures, const std::set<std::size_t>& poses) {
  const std::size_t low = std::max(*pictures.begin(), *poses.begin()),
                    high = std::min(*pictures.rbegin(), *poses.rbegin());
  const bool may_begin_elsewhere = low == 1 && std::min(*pictures.begin(), *poses.begin()) == 0;
  return low <= high && !may_begin_elsewhere &&
         std::equal(pictures.lower_bound(low), pictures.upper_bound(high), poses.lower_bound(low),
                    poses.upper_bound(high));
}

std::string told_apart(const std::set<std::size_t>& pictures, const std::set<std::size_t>& poses,
                       long apart) {
  if (std::abs(apart) <= 1) return "";
  const auto range = [](const std::set<std::size_t>& numbers) {
    return std::to_string(*numbers.begin()) + " to " + std::to_string(*numbers.rbegin());
  };
  return "numbers " + range(poses) + " are taken for pictures " + range(pictures) + ", in their order";
}

}  // namespace clearway
