#include "apps/print/sheet.hpp"

#include <cstdio>
#include <locale>
#include <sstream>

#include "datasets/simulation/tag_pattern.hpp"

namespace clearway {
namespace {

constexpr double kLineWidth = 0.15, kFoldDash = 1.5;  // mm
constexpr double kPointsPerMm = 72.0 / 25.4;

std::ostringstream plain() {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(9);
  return text;
}

std::string escaped_xml(const std::string& text) {
  std::string out;
  for (char c : text) {
    if (c == '<')
      out += "&lt;";
    else if (c == '&')
      out += "&amp;";
    else
      out += c;
  }
  return out;
}

std::string escaped_pdf(const std::string& text) {
  std::string out;
  for (char c : text) {
    if (c == '(' || c == ')' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

/// The page's marks in PDF's own words: millimetres, y up, by the transform that the first line sets.
std::string pdf_marks(const Sheet& sheet) {
  std::ostringstream text = plain();
  text << kPointsPerMm << " 0 0 " << -kPointsPerMm << " 0 " << sheet.height * kPointsPerMm << " cm\n";
  for (const Sheet::Area& area : sheet.areas)
    text << (area.is_black ? 0 : 1) << " g " << area.x << ' ' << area.y << ' ' << area.width << ' '
         << area.height << " re f\n";
  text << kLineWidth << " w 0.4 G\n";
  for (const Sheet::Line& line : sheet.lines) {
    if (line.is_fold)
      text << "[" << kFoldDash << "] 0 d ";
    else
      text << "[] 0 d ";
    text << line.x0 << ' ' << line.y0 << " m " << line.x1 << ' ' << line.y1 << " l S\n";
  }
  text << "0 g\n";
  for (const Sheet::Words& words : sheet.words)
    text << "BT /F " << words.size << " Tf 1 0 0 -1 " << words.x << ' ' << words.y << " Tm ("
         << escaped_pdf(words.text) << ") Tj ET\n";
  return text.str();
}

}  // namespace

void Sheet::tag(int id, double x, double y, double size) {
  const auto cells = tag36h11_cells(id);
  const double cell = size / 8.0;
  areas.push_back({x, y, size, size, true});
  for (int row = 1; row < 9; ++row)
    for (int column = 1; column < 9; ++column) {
      int end = column;
      while (end < 9 && cells[static_cast<std::size_t>(10 * row + end)]) ++end;
      if (end == column) continue;
      areas.push_back({x + (column - 1) * cell, y + (row - 1) * cell, (end - column) * cell, cell, false});
      column = end;
    }
}

void Sheet::ruler(double x, double y, double length) {
  lines.push_back({x, y, x + length, y, false});
  for (int mm = 0; mm <= static_cast<int>(length); mm += 5)
    lines.push_back({x + mm, y, x + mm, y - (mm % 10 == 0 ? 4.0 : 2.0), false});
  std::ostringstream text = plain();
  text << length << " mm: measure it; if it is not, print at 100 %";
  words.push_back({x, y + 4.0, 3.0, text.str()});
}

std::string to_svg(const Sheet& sheet) {
  std::ostringstream text = plain();
  text << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" << sheet.width << "mm\" height=\""
       << sheet.height << "mm\" viewBox=\"0 0 " << sheet.width << ' ' << sheet.height
       << "\" shape-rendering=\"crispEdges\">\n";
  for (const Sheet::Area& area : sheet.areas)
    text << "<rect x=\"" << area.x << "\" y=\"" << area.y << "\" width=\"" << area.width << "\" height=\""
         << area.height << "\" fill=\"" << (area.is_black ? "#000" : "#fff") << "\"/>\n";
  for (const Sheet::Line& line : sheet.lines) {
    text << "<line x1=\"" << line.x0 << "\" y1=\"" << line.y0 << "\" x2=\"" << line.x1 << "\" y2=\""
         << line.y1 << "\" stroke=\"#666\" stroke-width=\"" << kLineWidth << '"';
    if (line.is_fold) text << " stroke-dasharray=\"" << kFoldDash << '"';
    text << "/>\n";
  }
  for (const Sheet::Words& words : sheet.words)
    text << "<text x=\"" << words.x << "\" y=\"" << words.y << "\" font-size=\"" << words.size
         << "\" font-family=\"Helvetica, Arial, sans-serif\">" << escaped_xml(words.text) << "</text>\n";
  text << "</svg>\n";
  return text.str();
}

std::string to_pdf(const Sheet& sheet) {
  const std::string marks = pdf_marks(sheet);
  std::ostringstream page = plain();
  page << "<</Type/Page/Parent 2 0 R/MediaBox[0 0 " << sheet.width * kPointsPerMm << ' '
       << sheet.height * kPointsPerMm << "]/Contents 4 0 R/Resources<</Font<</F 5 0 R>>>>>>";
  const std::string objects[] = {
      "<</Type/Catalog/Pages 2 0 R/ViewerPreferences<</PrintScaling/None>>>>",
      "<</Type/Pages/Kids[3 0 R]/Count 1>>", page.str(),
      "<</Length " + std::to_string(marks.size()) + ">>\nstream\n" + marks + "endstream",
      "<</Type/Font/Subtype/Type1/BaseFont/Helvetica>>"};
  std::string file = "%PDF-1.6\n", table = "0000000000 65535 f \n";
  int number = 0;
  for (const std::string& object : objects) {
    char entry[32];
    std::snprintf(entry, sizeof entry, "%010zu 00000 n \n", file.size());
    table += entry;
    file += std::to_string(++number) + " 0 obj\n" + object + "\nendobj\n";
  }
  const std::size_t start = file.size();
  file += "xref\n0 6\n" + table + "trailer\n<</Size 6/Root 1 0 R>>\nstartxref\n" + std::to_string(start) +
          "\n%%EOF\n";
  return file;
}

}  // namespace clearway
