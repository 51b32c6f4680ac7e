// Campaigns of the root-cause benchmark, as a page sends them: whatever the bytes are, they are a
// campaign or refused with a reason. A campaign comes back as it was.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "rca_study/campaign_json.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace culprit;
  using namespace culprit::study::rca;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const Json json = parse_json(text);
  if (json.is_discarded()) return 0;
  const auto campaign = campaign_from_json(json);
  if (!campaign) {
    if (campaign.error().empty()) __builtin_trap();
    return 0;
  }
  const Json written = to_json(*campaign);
  const auto again = campaign_from_json(written);
  if (!again || to_json(*again) != written) __builtin_trap();
  return 0;
}
