#pragma once

#include <filesystem>
#include <string>

namespace clearway {

/// What a file or folder of a recording is that no reader of ours takes, and what to make of it that one
/// does, as "is …: expected …", by its name and what lies in it: recordings of cameras' own programs
/// (Record3D, ZED, OpenNI, Aria), packed files, archives. Empty: it is none that is known.
std::string unread_recording(const std::filesystem::path& recording);

/// A sentence on a video beside whose colours its file holds depth that is not read, as of an Azure Kinect
/// (k4arecorder's .mkv); empty for another.
std::string unread_depth_of(const std::filesystem::path& video);

}  // namespace clearway
