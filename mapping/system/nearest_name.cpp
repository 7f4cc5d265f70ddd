#include "mapping/system/nearest_name.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace clearway {
namespace {

std::string lower_case(std::string_view text) {
  std::string result(text);
  for (char& c : result) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return result;
}

/// Another order of the same letters is one slip.
bool is_slip(const std::string& name, const std::string& known) {
  if (name == known) return true;
  std::string a = name, b = known;
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  if (a == b) return true;
  return edit_distance(name, known) <= (known.size() <= 4 ? 1U : 2U);
}

/// Whether one of the two goes on where the other ends: rate and rate_hz.
bool continues(std::string_view a, std::string_view b) {
  constexpr std::size_t says_enough = 3;
  return std::min(a.size(), b.size()) >= says_enough && (a.starts_with(b) || b.starts_with(a));
}

}  // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

std::string nearest_name(std::string_view name, const std::vector<std::string>& known, std::size_t most) {
  const std::string* nearest = nullptr;
  std::pair<bool, std::size_t> least{true, 0};
  for (const std::string& one : known) {
    const std::pair key{!continues(name, one), edit_distance(name, one)};
    if (nearest == nullptr || key < least) nearest = &one, least = key;
  }
  return nearest == nullptr || (least.first && least.second > most) ? std::string() : *nearest;
}

std::string misspelt_name(std::string_view name, const std::vector<std::string>& known) {
  if (std::find(known.begin(), known.end(), name) != known.end()) return {};
  const std::string small = lower_case(name.substr(0, 100));
  const auto meant = std::find_if(known.begin(), known.end(),
                                  [&](const std::string& k) { return is_slip(small, lower_case(k)); });
  return meant == known.end() ? std::string() : *meant;
}

}  // namespace clearway
