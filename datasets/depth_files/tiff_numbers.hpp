#pragma once

#include <string>

namespace clearway {

/// The bytes of a TIFF whose pixels are whole numbers of 32 bits without a sign, such that they say they have
/// one, which is what OpenCV reads: depth of 2^31 steps and more, which no sensor has, is below 0 then. Other
/// bytes as they are.
std::string with_signed_numbers(std::string bytes);

}  // namespace clearway
