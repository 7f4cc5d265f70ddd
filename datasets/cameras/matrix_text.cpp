#include "datasets/cameras/matrix_text.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "datasets/sources/finite_number.hpp"

namespace clearway {
namespace {

/// The numbers of each line that holds something; nothing when there is a word that is none.
std::optional<std::vector<std::vector<double>>> number_rows(const std::string& text) {
  std::vector<std::vector<double>> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    line.resize(std::min(line.find('#'), line.size()));
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream stream(line);
    std::vector<double> row;
    for (std::string word; stream >> word;) {
      const auto number = finite_number(word.starts_with('+') ? word.substr(1) : word);
      if (!number) return std::nullopt;
      row.push_back(*number);
    }
    if (!row.empty()) rows.push_back(std::move(row));
  }
  return rows;
}

/// Whether it is [fx, 0, cx; 0, fy, cy; 0, 0, 1], in the corner of a matrix that turns and moves nothing.
bool is_camera_matrix(const std::vector<std::vector<double>>& rows) {
  const std::size_t size = rows.size();
  if (size != 3 && size != 4) return false;
  for (std::size_t i = 0; i < size; ++i) {
    if (rows[i].size() != size) return false;
    for (std::size_t j = 0; j < size; ++j) {
      const bool is_free = i < 2 && (j == i || j == 2);
      if (!is_free && rows[i][j] != (i == j ? 1.0 : 0.0)) return false;
    }
  }
  return rows[0][0] > 0.0 && rows[1][1] > 0.0;
}

/// Whether it is fx fy cx cy, as in ETH3D's calibration.txt.
bool is_four_numbers(const std::vector<std::vector<double>>& rows) {
  return rows.size() == 1 && rows[0].size() == 4 && rows[0][0] > 0.0 && rows[0][1] > 0.0;
}

}  // namespace

bool is_numbers_alone(const std::string& text) {
  const auto rows = number_rows(text);
  return rows && !rows->empty();
}

CameraIntrinsics camera_of_matrix_text(const std::string& text, const std::string& name,
                                       std::optional<ImageSize> size) {
  const auto rows = number_rows(text);
  constexpr double most = 1e6;
  const auto is_far = [](const std::vector<double>& row) {
    return std::any_of(row.begin(), row.end(), [](double number) { return std::abs(number) > most; });
  };
  const bool is_row = rows && is_four_numbers(*rows);
  if (!rows || !(is_row || is_camera_matrix(*rows)) || std::any_of(rows->begin(), rows->end(), is_far))
    throw std::invalid_argument(
        name +
        ": expected a matrix of 3 or 4 rows, [fx 0 cx], [0 fy cy], [0 0 1], each "
        "with a 0 at its end where there are 4, and then 0 0 0 1; or one row, fx fy cx cy");
  if (!size)
    throw std::invalid_argument(name +
                                " has a matrix alone, which does not say how large the pictures are: "
                                "expected `width` and `height` beside `file`");
  const auto& k = *rows;
  if (is_row) return {size->width, size->height, k[0][0], k[0][1], k[0][2], k[0][3], {}};
  return {size->width, size->height, k[0][0], k[1][1], k[0][2], k[1][2], {}};
}

}  // namespace clearway
