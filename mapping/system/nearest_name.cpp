#include "mapping/system/nearest_name.hpp"

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

#include "mapping/system/plain_text.hpp"

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

/// Whether one of the two goes on where the other ends, or ends in it as a word: rate and rate_hz,
/// tolerance and turn-tolerance.
bool continues(std::string_view a, std::string_view b) {
  constexpr std::size_t says_enough = 3;
  if (a.size() > b.size()) std::swap(a, b);
  if (a.size() < says_enough) return false;
  if (b.starts_with(a)) return true;
  return b.ends_with(a) &&
         std::string_view("_-. ").find(b[b.size() - a.size() - 1]) != std::string_view::npos;
}

std::string_view last_word(std::string_view name) {
  const std::size_t end = name.find_last_of("_-. ");
  return end == std::string_view::npos ? name : name.substr(end + 1);
}

/// Edits that still leave a name of so many letters recognizable.
std::size_t most_edits(std::size_t letters) {
  return letters < 2 ? 0 : std::max<std::size_t>(1, letters / 3);
}

/// How one name is like another, then by how many edits: the less the nearer.
using Nearness = std::pair<int, std::size_t>;

/// None: they share too little.
std::optional<Nearness> nearness(const std::string& name, const std::string& known) {
  const auto are_near = [](std::string_view a, std::string_view b) {
    return edit_distance(a, b) <= most_edits(std::min(a.size(), b.size()));
  };
  if (continues(name, known)) return Nearness{0, edit_distance(name, known)};
  if (are_near(name, known)) return Nearness{1, edit_distance(name, known)};
  const std::string_view a = last_word(name), b = last_word(known);
  const bool is_one_word = a.size() == name.size() || b.size() == known.size();
  if (is_one_word && are_near(a, b)) return Nearness{2, edit_distance(a, b)};
  return std::nullopt;
}

}  // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1), above, two_above;
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    two_above = std::exchange(above, row);
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      row[j + 1] = std::min({above[j] + (a[i] == b[j] ? 0 : 1), row[j] + 1, above[j + 1] + 1});
      if (i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j])
        row[j + 1] = std::min(row[j + 1], two_above[j - 1] + 1);
    }
  }
  return row.back();
}

std::string nearest_name(std::string_view name, const std::vector<std::string>& known) {
  const std::string small = lower_case(name.substr(0, 100));
  const std::string* nearest = nullptr;
  Nearness least;
  for (const std::string& one : known) {
    const std::optional<Nearness> near = nearness(small, lower_case(one));
    if (near && (nearest == nullptr || *near < least)) nearest = &one, least = *near;
  }
  return nearest == nullptr ? std::string() : *nearest;
}

std::string suggestion(std::string_view name, const std::vector<std::string>& known) {
  const std::string nearest = nearest_name(name, known);
  if (!nearest.empty()) return "did you mean " + quote(nearest) + "?";
  return known.empty() ? "expected none" : "expected one of " + listed(known);
}

std::string misspelt_name(std::string_view name, const std::vector<std::string>& known) {
  if (std::find(known.begin(), known.end(), name) != known.end()) return {};
  const std::string small = lower_case(name.substr(0, 100));
  const auto meant = std::find_if(known.begin(), known.end(),
                                  [&](const std::string& k) { return is_slip(small, lower_case(k)); });
  return meant == known.end() ? std::string() : *meant;
}

}  // namespace clearway
