#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "apps/overlay/canvas.hpp"

namespace cv {
class Mat;
}

namespace clearway {

/// The lines at the lower edge of a picture. Empty ones take no room; one that is too long for the picture
/// takes more, and is cut and ends in "..." if these do not do.
struct Strip {
  std::string state;           ///< what goes on
  std::string refusal;         ///< the last thing refused, and why
  std::string cure;            ///< what helps against it
  std::string keys;            ///< what may be pressed
  double clearance_m = 0.0;    ///< > 0: a scale of clearances up to this, right of the state
  std::size_t most_lines = 2;  ///< of each
};

/// What a person can do when an image painted nothing, one sentence; empty where nothing helps.
/// @param refusal its word, as to_string(Refusal) has it
std::string cure_of(std::string_view refusal);

/// The text in the characters that the picture's font has, others as '?', cut to `width` pixels.
std::string fitting_text(std::string_view text, double scale, int width);

/// The text in lines of at most `width` pixels, broken between words; what the last of `most` lines does not
/// hold is cut.
std::vector<std::string> fitting_lines(std::string_view text, double scale, int width, std::size_t most);

/// Text with a dark edge, legible on dark and bright images. @param x, y left end of the baseline, pixels
void draw_text(cv::Mat& picture, const std::string& text, int x, int y, double scale, Colour colour);

/// Size of text for a picture of that height: the scale of OpenCV's font.
double text_scale(int picture_height);

void draw_strip(cv::Mat& picture, const Strip& strip);

}  // namespace clearway
