#include "ros2/standard_messages.h"

#include <algorithm>
#include <array>

namespace culprit::ros2 {
namespace {

// In alphabetic order.
constexpr auto kMessages = std::to_array<StandardMessage>({
    {"action_msgs/msg/GoalInfo",
     "unique_identifier_msgs/UUID goal_id\nbuiltin_interfaces/Time stamp"},
    {"action_msgs/msg/GoalStatus", "GoalInfo goal_info\nint8 status"},
    {"action_msgs/msg/GoalStatusArray", "GoalStatus[] status_list"},
    {"action_msgs/srv/CancelGoal_Request", "action_msgs/GoalInfo goal_info"},
    {"action_msgs/srv/CancelGoal_Response",
     "int8 return_code\naction_msgs/GoalInfo[] goals_canceling"},

    {"builtin_interfaces/msg/Duration", "int32 sec\nuint32 nanosec"},
    {"builtin_interfaces/msg/Time", "int32 sec\nuint32 nanosec"},

    {"diagnostic_msgs/msg/DiagnosticArray", "std_msgs/Header header\nDiagnosticStatus[] status"},
    {"diagnostic_msgs/msg/DiagnosticStatus",
     "byte level\nstring name\nstring message\nstring hardware_id\nKeyValue[] values"},
    {"diagnostic_msgs/msg/KeyValue", "string key\nstring value"},

    {"geometry_msgs/msg/Accel", "Vector3 linear\nVector3 angular"},
    {"geometry_msgs/msg/AccelStamped", "std_msgs/Header header\nAccel accel"},
    {"geometry_msgs/msg/Inertia",
     "float64 m\nVector3 com\nfloat64 ixx\nfloat64 ixy\nfloat64 ixz\nfloat64 iyy\nfloat64 iyz\n"
     "float64 izz"},
    {"geometry_msgs/msg/Point", "float64 x\nfloat64 y\nfloat64 z"},
    {"geometry_msgs/msg/Point32", "float32 x\nfloat32 y\nfloat32 z"},
    {"geometry_msgs/msg/PointStamped", "std_msgs/Header header\nPoint point"},
    {"geometry_msgs/msg/Polygon", "Point32[] points"},
    {"geometry_msgs/msg/PolygonStamped", "std_msgs/Header header\nPolygon polygon"},
    {"geometry_msgs/msg/Pose", "Point position\nQuaternion orientation"},
    {"geometry_msgs/msg/Pose2D", "float64 x\nfloat64 y\nfloat64 theta"},
    {"geometry_msgs/msg/PoseArray", "std_msgs/Header header\nPose[] poses"},
    {"geometry_msgs/msg/PoseStamped", "std_msgs/Header header\nPose pose"},
    {"geometry_msgs/msg/PoseWithCovariance", "Pose pose\nfloat64[36] covariance"},
    {"geometry_msgs/msg/PoseWithCovarianceStamped",
     "std_msgs/Header header\nPoseWithCovariance pose"},
    {"geometry_msgs/msg/Quaternion", "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1"},
    {"geometry_msgs/msg/QuaternionStamped", "std_msgs/Header header\nQuaternion quaternion"},
    {"geometry_msgs/msg/Transform", "Vector3 translation\nQuaternion rotation"},
    {"geometry_msgs/msg/TransformStamped",
     "std_msgs/Header header\nstring child_frame_id\nTransform transform"},
    {"geometry_msgs/msg/Twist", "Vector3 linear\nVector3 angular"},
    {"geometry_msgs/msg/TwistStamped", "std_msgs/Header header\nTwist twist"},
    {"geometry_msgs/msg/TwistWithCovariance", "Twist twist\nfloat64[36] covariance"},
    {"geometry_msgs/msg/TwistWithCovarianceStamped",
     "std_msgs/Header header\nTwistWithCovariance twist"},
    {"geometry_msgs/msg/Vector3", "float64 x\nfloat64 y\nfloat64 z"},
    {"geometry_msgs/msg/Vector3Stamped", "std_msgs/Header header\nVector3 vector"},
    {"geometry_msgs/msg/Wrench", "Vector3 force\nVector3 torque"},
    {"geometry_msgs/msg/WrenchStamped", "std_msgs/Header header\nWrench wrench"},

    {"lifecycle_msgs/msg/State", "uint8 id\nstring label"},
    {"lifecycle_msgs/msg/Transition", "uint8 id\nstring label"},
    {"lifecycle_msgs/msg/TransitionDescription",
     "Transition transition\nState start_state\nState goal_state"},
    {"lifecycle_msgs/msg/TransitionEvent",
     "uint64 timestamp\nTransition transition\nState start_state\nState goal_state"},

    {"nav_msgs/msg/GridCells",
     "std_msgs/Header header\nfloat32 cell_width\nfloat32 cell_height\n"
     "geometry_msgs/Point[] cells"},
    {"nav_msgs/msg/MapMetaData",
     "builtin_interfaces/Time map_load_time\nfloat32 resolution\nuint32 width\nuint32 height\n"
     "geometry_msgs/Pose origin"},
    {"nav_msgs/msg/OccupancyGrid", "std_msgs/Header header\nMapMetaData info\nint8[] data"},
    {"nav_msgs/msg/Odometry",
     "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n"
     "geometry_msgs/TwistWithCovariance twist"},
    {"nav_msgs/msg/Path", "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses"},

    {"rcl_interfaces/msg/Log",
     "builtin_interfaces/Time stamp\nuint8 level\nstring name\nstring msg\nstring file\n"
     "string function\nuint32 line"},
    {"rcl_interfaces/msg/Parameter", "string name\nParameterValue value"},
    {"rcl_interfaces/msg/ParameterEvent",
     "builtin_interfaces/Time stamp\nstring node\nParameter[] new_parameters\n"
     "Parameter[] changed_parameters\nParameter[] deleted_parameters"},
    {"rcl_interfaces/msg/ParameterValue",
     "uint8 type\nbool bool_value\nint64 integer_value\nfloat64 double_value\nstring string_value\n"
     "byte[] byte_array_value\nbool[] bool_array_value\nint64[] integer_array_value\n"
     "float64[] double_array_value\nstring[] string_array_value"},
    {"rcl_interfaces/msg/SetParametersResult", "bool successful\nstring reason"},
    {"rcl_interfaces/srv/SetParametersAtomically_Request", "Parameter[] parameters"},
    {"rcl_interfaces/srv/SetParametersAtomically_Response", "SetParametersResult result"},

    {"rosgraph_msgs/msg/Clock", "builtin_interfaces/Time clock"},

    {"sensor_msgs/msg/BatteryState",
     "std_msgs/Header header\nfloat32 voltage\nfloat32 temperature\nfloat32 current\n"
     "float32 charge\nfloat32 capacity\nfloat32 design_capacity\nfloat32 percentage\n"
     "uint8 power_supply_status\nuint8 power_supply_health\nuint8 power_supply_technology\n"
     "bool present\nfloat32[] cell_voltage\nfloat32[] cell_temperature\nstring location\n"
     "string serial_number"},
    {"sensor_msgs/msg/CameraInfo",
     "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] d\n"
     "float64[9] k\nfloat64[9] r\nfloat64[12] p\nuint32 binning_x\nuint32 binning_y\n"
     "RegionOfInterest roi"},
    {"sensor_msgs/msg/CompressedImage", "std_msgs/Header header\nstring format\nuint8[] data"},
    {"sensor_msgs/msg/FluidPressure",
     "std_msgs/Header header\nfloat64 fluid_pressure\nfloat64 variance"},
    {"sensor_msgs/msg/Illuminance",
     "std_msgs/Header header\nfloat64 illuminance\nfloat64 variance"},
    {"sensor_msgs/msg/Image",
     "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\n"
     "uint32 step\nuint8[] data"},
    {"sensor_msgs/msg/Imu",
     "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\n"
     "float64[9] orientation_covariance\ngeometry_msgs/Vector3 angular_velocity\n"
     "float64[9] angular_velocity_covariance\ngeometry_msgs/Vector3 linear_acceleration\n"
     "float64[9] linear_acceleration_covariance"},
    {"sensor_msgs/msg/JointState",
     "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\n"
     "float64[] effort"},
    {"sensor_msgs/msg/Joy", "std_msgs/Header header\nfloat32[] axes\nint32[] buttons"},
    {"sensor_msgs/msg/LaserScan",
     "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n"
     "float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\n"
     "float32[] ranges\nfloat32[] intensities"},
    {"sensor_msgs/msg/MagneticField",
     "std_msgs/Header header\ngeometry_msgs/Vector3 magnetic_field\n"
     "float64[9] magnetic_field_covariance"},
    {"sensor_msgs/msg/NavSatFix",
     "std_msgs/Header header\nNavSatStatus status\nfloat64 latitude\nfloat64 longitude\n"
     "float64 altitude\nfloat64[9] position_covariance\nuint8 position_covariance_type"},
    {"sensor_msgs/msg/NavSatStatus", "int8 status\nuint16 service"},
    {"sensor_msgs/msg/PointCloud2",
     "std_msgs/Header header\nuint32 height\nuint32 width\nPointField[] fields\n"
     "bool is_bigendian\nuint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense"},
    {"sensor_msgs/msg/PointField", "string name\nuint32 offset\nuint8 datatype\nuint32 count"},
    {"sensor_msgs/msg/Range",
     "std_msgs/Header header\nuint8 radiation_type\nfloat32 field_of_view\nfloat32 min_range\n"
     "float32 max_range\nfloat32 range"},
    {"sensor_msgs/msg/RegionOfInterest",
     "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify"},
    {"sensor_msgs/msg/RelativeHumidity",
     "std_msgs/Header header\nfloat64 relative_humidity\nfloat64 variance"},
    {"sensor_msgs/msg/Temperature",
     "std_msgs/Header header\nfloat64 temperature\nfloat64 variance"},
    {"sensor_msgs/msg/TimeReference",
     "std_msgs/Header header\nbuiltin_interfaces/Time time_ref\nstring source"},

    {"service_msgs/msg/ServiceEventInfo",
     "uint8 event_type\nbuiltin_interfaces/Time stamp\nchar[16] client_gid\n"
     "int64 sequence_number"},

    {"std_msgs/msg/Bool", "bool data"},
    {"std_msgs/msg/Byte", "byte data"},
    {"std_msgs/msg/Char", "char data"},
    {"std_msgs/msg/ColorRGBA", "float32 r\nfloat32 g\nfloat32 b\nfloat32 a"},
    {"std_msgs/msg/Empty", ""},
    {"std_msgs/msg/Float32", "float32 data"},
    {"std_msgs/msg/Float32MultiArray", "MultiArrayLayout layout\nfloat32[] data"},
    {"std_msgs/msg/Float64", "float64 data"},
    {"std_msgs/msg/Float64MultiArray", "MultiArrayLayout layout\nfloat64[] data"},
    {"std_msgs/msg/Header", "builtin_interfaces/Time stamp\nstring frame_id"},
    {"std_msgs/msg/Int16", "int16 data"},
    {"std_msgs/msg/Int32", "int32 data"},
    {"std_msgs/msg/Int32MultiArray", "MultiArrayLayout layout\nint32[] data"},
    {"std_msgs/msg/Int64", "int64 data"},
    {"std_msgs/msg/Int8", "int8 data"},
    {"std_msgs/msg/MultiArrayDimension", "string label\nuint32 size\nuint32 stride"},
    {"std_msgs/msg/MultiArrayLayout", "MultiArrayDimension[] dim\nuint32 data_offset"},
    {"std_msgs/msg/String", "string data"},
    {"std_msgs/msg/UInt16", "uint16 data"},
    {"std_msgs/msg/UInt32", "uint32 data"},
    {"std_msgs/msg/UInt64", "uint64 data"},
    {"std_msgs/msg/UInt8", "uint8 data"},

    {"std_srvs/srv/Empty_Request", ""},
    {"std_srvs/srv/Empty_Response", ""},
    {"std_srvs/srv/SetBool_Request", "bool data"},
    {"std_srvs/srv/SetBool_Response", "bool success\nstring message"},
    {"std_srvs/srv/Trigger_Request", ""},
    {"std_srvs/srv/Trigger_Response", "bool success\nstring message"},

    {"system_modes_msgs/msg/Mode", "string label"},
    {"system_modes_msgs/msg/ModeEvent", "uint64 timestamp\nMode start_mode\nMode goal_mode"},

    {"tf2_msgs/msg/TFMessage", "geometry_msgs/TransformStamped[] transforms"},

    {"unique_identifier_msgs/msg/UUID", "uint8[16] uuid"},
});

static_assert(std::ranges::is_sorted(kMessages, {}, &StandardMessage::type));

}  // namespace

std::span<const StandardMessage> standard_messages() { return kMessages; }

std::optional<std::string_view> standard_message(std::string_view type) {
  const auto found = std::ranges::lower_bound(kMessages, type, {}, &StandardMessage::type);
  if (found == kMessages.end() || found->type != type) return std::nullopt;
  return found->text;
}

}  // namespace culprit::ros2
