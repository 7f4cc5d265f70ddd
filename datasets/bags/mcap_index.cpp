#include "datasets/bags/mcap_index.hpp"

#include <algorithm>
#include <stdexcept>

namespace clearway {

std::uint16_t McapIndex::read(mcap::Bytes content, const std::function<void(const Entry&)>& take) {
  constexpr std::uint32_t entry_bytes = 16;
  mcap::Fields in(content);
  const auto channel = in.number<std::uint16_t>();
  for (auto bytes = in.number<std::uint32_t>(); bytes >= entry_bytes; bytes -= entry_bytes) {
    const auto time = in.number<std::uint64_t>();
    take({in.number<std::uint64_t>(), time, channel});
  }
  return channel;
}

void McapIndex::add(std::uint64_t chunk, mcap::Bytes content, std::uint64_t at) {
  try {
    std::vector<std::uint64_t> times;
    const std::uint16_t channel = read(content, [&](const Entry& entry) { times.push_back(entry.time); });
    if (times.empty()) return;
    const auto [first, last] = std::minmax_element(times.begin(), times.end());
    auto& span = times_.try_emplace(channel, *first, *last).first->second;
    span = {std::min(span.first, *first), std::max(span.second, *last)};
    counts_[channel] += times.size();
    chunks_[chunk].push_back({channel, at, content.size()});
  } catch (const std::runtime_error&) {  // lists() will miss its messages
  }
}

bool McapIndex::lists(const std::map<std::uint16_t, std::uint64_t>& counts) const {
  auto stated = counts;
  std::erase_if(stated, [](const auto& channel) { return channel.second == 0; });
  return stated == counts_;
}

const std::vector<McapIndex::Channel>& McapIndex::channels_at(std::uint64_t chunk) const {
  static const std::vector<Channel> none;
  const auto found = chunks_.find(chunk);
  return found == chunks_.end() ? none : found->second;
}

}  // namespace clearway
