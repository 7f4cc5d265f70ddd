#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace clearway {

/// The numbers in the names of pictures, which are those of a recording's frames: the only digits of a name
/// that differ from picture to picture, at the same place in all of them (000012 of cam1_000012.png and of
/// frame-000012.depth.png; Redwood's 0000012-000000400000 is 12). Empty where not every name has one of its
/// own, or where they are a clock's.
std::map<std::filesystem::path, std::size_t> numbers_in_names(
    const std::vector<std::filesystem::path>& pictures);

/// What has to be added to the numbers of poses to make them those of pictures, each set in its own count: 0
/// where one has all of the other; 1 or -1 where that is so only when the one begins at 0 and the other at 1;
/// any where there are as many of both, they are the same but for it, and all poses are numbered beyond all
/// pictures or below: else a picture would take another's pose. @throws std::invalid_argument with a
/// clause without a name, where they contradict each other, or both may be so
long numbers_apart(const std::set<std::size_t>& pictures, const std::set<std::size_t>& poses);

/// Whether poses and pictures have the same numbers where both have any, as of a recording of which each lost
/// another end; false where the one begins at 0 and the other at 1.
bool overlap_alike(const std::set<std::size_t>& pictures, const std::set<std::size_t>& poses);

/// A clause that tells which numbers of poses are taken for which pictures; empty where they are the same, or
/// one count begins at 0 and the other at 1.
std::string told_apart(const std::set<std::size_t>& pictures, const std::set<std::size_t>& poses, long apart);

}  // namespace clearway
