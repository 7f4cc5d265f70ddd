#include "apps/overlay/strip.hpp"

#include <algorithm>
#include <array>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "apps/console/parse.hpp"
#include "apps/overlay/overlay_scene.hpp"

namespace clearway {
namespace {

constexpr int font = cv::FONT_HERSHEY_SIMPLEX;

struct TextLine {
  std::string text;
  Colour colour;
};

int width_of(const std::string& text, double scale, int thickness) {
  int baseline = 0;
  return cv::getTextSize(text, font, scale, thickness, &baseline).width;
}

int stroke(double scale) { return std::max(1, static_cast<int>(std::lround(1.6 * scale))); }

/// One '?' for each character that is not ASCII.
std::string ascii(std::string_view text) {
  std::string result;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte & 0xc0U) == 0x80U) continue;  // a further byte of a character
    result += byte < 0x20 || byte == 0x7f ? ' ' : byte < 0x80 ? c : '?';
  }
  return result;
}

/// A bar of colours with its ends named, right of the first line.
struct ClearanceScale {
  ClearanceScale(double most_m, int columns, double scale)
      : most(most_m), high(significant(1000.0 * most_m, 2) + " mm"), bar(columns / 8) {
    gap = static_cast<int>(12 * scale);
    low_width = width_of(low, scale, stroke(scale));
    room = low_width + bar + width_of(high, scale, stroke(scale)) + 5 * gap;
    if (most <= 0.0 || room > columns / 2) room = 0;
  }

  double most;  ///< m
  std::string low = "clearance 0", high;
  int bar, gap = 0, low_width = 0;
  int room = 0;  ///< that it takes, pixels; 0: it is not drawn
};

void draw_scale(cv::Mat& picture, const ClearanceScale& drawn, int baseline, double scale) {
  const auto& [most, low, high, bar, gap, low_width, room] = drawn;
  if (room == 0) return;
  const int left = picture.cols - room + gap, height = static_cast<int>(14 * scale);
  const Colour bright{235, 235, 235};
  draw_text(picture, low, left, baseline, scale, bright);
  for (int x = 0; x < bar; ++x) {
    const Colour c = clearance_colour(most * x / bar, most);
    cv::line(picture, {left + low_width + gap + x, baseline - height}, {left + low_width + gap + x, baseline},
             cv::Scalar(c.blue, c.green, c.red));
  }
  draw_text(picture, high, left + low_width + bar + 2 * gap, baseline, scale, bright);
}

}  // namespace

std::string cure_of(std::string_view refusal) {
  static const std::array<std::pair<std::string_view, std::string_view>, 10> cures{{
      {"base_not_seen", "Keep the fixed board in view."},
      {"probe_not_seen", "Turn a tag of the probe towards the camera."},
      {"too_few_tags", "Show more tags of the probe and the fixed board."},
      {"reprojection_error", "Hold still, keep the tags flat and in light; else calibrate the camera anew."},
      {"ambiguous_pose", "Come nearer, or show a second tag of the probe."},
      {"base_moved", "Put camera and fixed board back, or begin anew."},
      {"uncertain_center", "Come nearer, or show more tags of the probe."},
      {"unconfirmed", "Show two tags of probe and fixed board, or keep them in view a moment longer."},
      {"too_fast", "Move more slowly."},
      {"image_refused", "Use the camera that the setup describes."},
  }};
  const auto* const found =
      std::find_if(cures.begin(), cures.end(), [&](const auto& cure) { return cure.first == refusal; });
  return found == cures.end() ? "" : std::string(found->second);
}

double text_scale(int picture_height) { return std::max(0.4, picture_height / 1100.0); }

std::string fitting_text(std::string_view text, double scale, int width) {
  std::string whole = ascii(text);
  if (width_of(whole, scale, stroke(scale)) <= width) return whole;
  std::size_t low = 0, high = whole.size();  // that many characters fit, that many do not
  const auto cut = [&](std::size_t count) { return whole.substr(0, count) + "..."; };
  if (width_of(cut(0), scale, stroke(scale)) > width) return "";
  while (high - low > 1) {
    const std::size_t middle = (low + high) / 2;
    (width_of(cut(middle), scale, stroke(scale)) <= width ? low : high) = middle;
  }
  return cut(low);
}

std::vector<std::string> fitting_lines(std::string_view text, double scale, int width, std::size_t most) {
  std::vector<std::string> lines;
  std::string rest = ascii(text);
  const auto fits = [&](const std::string& line) { return width_of(line, scale, stroke(scale)) <= width; };
  while (lines.size() + 1 < most && !fits(rest)) {
    std::size_t end = std::string::npos;  // of the longest line that fits, between words
    for (std::size_t gap = rest.find(' '); gap != std::string::npos && fits(rest.substr(0, gap));
         gap = rest.find(' ', gap + 1))
      end = gap;
    if (end == std::string::npos || end == 0) break;
    lines.push_back(rest.substr(0, end));
    rest.erase(0, rest.find_first_not_of(' ', end));
  }
  lines.push_back(fitting_text(rest, scale, width));
  return lines;
}

void draw_text(cv::Mat& picture, const std::string& text, int x, int y, double scale, Colour colour) {
  const cv::Point at(x, y);
  const int thick = stroke(scale);
  cv::putText(picture, text, at, font, scale, cv::Scalar(20, 20, 20), thick + 2, cv::LINE_AA);
  cv::putText(picture, text, at, font, scale, cv::Scalar(colour.blue, colour.green, colour.red), thick,
              cv::LINE_AA);
}

void draw_strip(cv::Mat& picture, const Strip& strip) {
  const Colour white{255, 255, 255}, amber{255, 190, 70}, pale{150, 220, 255}, grey{190, 190, 190};
  const double scale = text_scale(picture.rows);
  const int line_height = static_cast<int>(36 * scale), border = static_cast<int>(16 * scale);
  const int width = picture.cols - 2 * border;
  const ClearanceScale colours(strip.clearance_m, picture.cols, scale);
  std::vector<TextLine> lines;
  const auto add = [&](const std::string& text, Colour colour, int room) {
    if (text.empty()) return;
    for (const std::string& line : fitting_lines(text, scale, width - room, strip.most_lines))
      lines.push_back({line, colour});
  };
  add(strip.state, white, colours.room);  // which is beside it
  add(strip.refusal, amber, 0);
  add(strip.cure, pale, 0);
  add(strip.keys, grey, 0);
  if (lines.empty()) return;
  const int count = static_cast<int>(lines.size());
  const int height = std::min(picture.rows, count * line_height + border);
  cv::Mat covered = picture.rowRange(picture.rows - height, picture.rows);
  covered.convertTo(covered, -1, 0.22, 6.0);
  for (int i = 0; i < count; ++i) {
    const int baseline = picture.rows - height + (i + 1) * line_height - border / 4;
    const TextLine& line = lines[static_cast<std::size_t>(i)];
    draw_text(picture, line.text, border, baseline, scale, line.colour);
    if (i == 0) draw_scale(picture, colours, baseline, scale);
  }
}

}  // namespace clearway
