// perception_container: a component container as rclcpp_components has it, for the camera and cloud_maker.
#include <cstring>
#include <map>

#include "exemplars/rover/nodes.h"
#include "ros2/services.h"

namespace culprit::rover {
namespace {

// cloud_maker: from each /camera/image_raw a cloud of 331 kB, /points. Its status has `clouds`, their number since the status before.
//
// Fault: "stall".
class CloudMaker final : public RoverNode {
 public:
  using RoverNode::RoverNode;

 private:
  static constexpr std::uint32_t kFiner = 4;

  void set_up() override {
    offer(cloud_, "/points", rtps::qos::kSensorData);
    hear<ros2::msg::Image>("/camera/image_raw", rtps::qos::kSensorData,
                           [this](const ros2::msg::Image& image) {
                             if (has("stall")) return;
                             cloud_->publish(cloud_of(image));
                             ++clouds_;
                           });
  }

  static msg::PointCloud2 cloud_of(const ros2::msg::Image& image) {
    msg::PointCloud2 cloud;
    cloud.header = image.header;
    cloud.height = image.height * kFiner;
    cloud.width = image.width * kFiner;
    cloud.row_step = cloud.point_step * cloud.width;
    for (const char* axis : {"x", "y", "z"})
      cloud.fields.push_back({axis, static_cast<std::uint32_t>(4 * cloud.fields.size())});
    cloud.data.resize(std::size_t{cloud.row_step} * cloud.height);
    std::uint8_t* to = cloud.data.data();
    for (std::uint32_t i = 0; i < cloud.height * cloud.width; ++i, to += cloud.point_step) {
      const std::uint32_t column = i % cloud.width / kFiner;
      const std::uint32_t row = i / cloud.width / kFiner;
      const float depth = 8 - 0.03F * static_cast<float>(image.data[row * image.width + column]);
      const float point[] = {depth, depth * (0.6F - 0.025F * static_cast<float>(column)),
                             depth * (0.45F - 0.025F * static_cast<float>(row))};
      std::memcpy(to, point, sizeof(point));
    }
    return cloud;
  }

  std::vector<ros2::msg::KeyValue> values() override {
    return {{"clouds", std::to_string(std::exchange(clouds_, 0))}};
  }

  int clouds_ = 0;
  std::optional<ros2::Publisher<msg::PointCloud2>> cloud_;
};

class PerceptionContainer final : public RoverNode {
 public:
  using RoverNode::RoverNode;

 private:
  void set_up() override {
    using namespace ros2::srv;
    serve<LoadNode>("~/_container/load_node",
                    [this](const auto& request) { return load(request); });
    serve<UnloadNode>("~/_container/unload_node", [this](const auto& request) {
      const bool is_done = loaded_.erase(request.unique_id) > 0;
      return UnloadNode::Response{is_done, is_done ? "" : "no node has that unique_id"};
    });
    serve<ListNodes>("~/_container/list_nodes", [this](const auto&) {
      ListNodes::Response all;
      for (const auto& [id, node] : loaded_) {
        all.unique_ids.push_back(id);
        all.full_node_names.push_back(node->full_name());
      }
      return all;
    });
  }

  ros2::srv::LoadNode::Response load(const ros2::srv::LoadNode::Request& request) {
    const Process& process =
        request.plugin_name == "rover::CameraDriver" ? kCameraDriver : kCloudMaker;
    auto loaded = process.make({.node = "/" + request.node_name, .state = settings().state});
    if (auto opened = loaded->open(node().context()); !opened)
      return {false, opened.error(), "", 0};
    loaded_[++last_id_] = std::move(loaded);
    return {true, "", loaded_[last_id_]->full_name(), last_id_};
  }

  std::map<std::uint64_t, std::unique_ptr<RoverNode>> loaded_;
  std::uint64_t last_id_ = 0;
};

}  // namespace

const Process kCloudMaker = {"cloud_maker", make<CloudMaker>, true, true};
const Process kPerceptionContainer = {"perception_container", make<PerceptionContainer>};

}  // namespace culprit::rover
