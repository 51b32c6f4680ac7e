#include "ros2/standard_messages.h"

#include <algorithm>
#include <array>

namespace culprit::ros2 {
namespace {

// In alphabetic order.
constexpr auto kMessages = std::to_array<StandardMessage>({
    {"ackermann_msgs/msg/AckermannDrive",
     "float32 steering_angle\nfloat32 steering_angle_velocity\nfloat32 speed\n"
     "float32 acceleration\nfloat32 jerk"},
    {"ackermann_msgs/msg/AckermannDriveStamped", "std_msgs/Header header\nAckermannDrive drive"},

    {"action_msgs/msg/GoalInfo",
     "unique_identifier_msgs/UUID goal_id\nbuiltin_interfaces/Time stamp"},
    {"action_msgs/msg/GoalStatus", "GoalInfo goal_info\nint8 status"},
    {"action_msgs/msg/GoalStatusArray", "GoalStatus[] status_list"},
    {"action_msgs/srv/CancelGoal_Request", "action_msgs/GoalInfo goal_info"},
    {"action_msgs/srv/CancelGoal_Response",
     "int8 return_code\naction_msgs/GoalInfo[] goals_canceling"},

    {"builtin_interfaces/msg/Duration", "int32 sec\nuint32 nanosec"},
    {"builtin_interfaces/msg/Time", "int32 sec\nuint32 nanosec"},

    {"can_msgs/msg/Frame",
     "std_msgs/Header header\nuint32 id\nbool is_rtr\nbool is_extended\nbool is_error\n"
     "uint8 dlc\nuint8[8] data"},

    {"control_msgs/msg/DynamicJointState",
     "std_msgs/Header header\nstring[] joint_names\nInterfaceValue[] interface_values"},
    {"control_msgs/msg/GripperCommand", "float64 position\nfloat64 max_effort"},
    {"control_msgs/msg/InterfaceValue", "string[] interface_names\nfloat64[] values"},
    {"control_msgs/msg/JointControllerState",
     "std_msgs/Header header\nfloat64 set_point\nfloat64 process_value\n"
     "float64 process_value_dot\nfloat64 error\nfloat64 time_step\nfloat64 command\n"
     "float64 p\nfloat64 i\nfloat64 d\nfloat64 i_clamp\nbool antiwindup"},
    {"control_msgs/msg/JointJog",
     "std_msgs/Header header\nstring[] joint_names\nfloat64[] displacements\n"
     "float64[] velocities\nfloat64 duration"},
    {"control_msgs/msg/JointTolerance",
     "string name\nfloat64 position\nfloat64 velocity\nfloat64 acceleration"},
    {"control_msgs/msg/JointTrajectoryControllerState",
     "std_msgs/Header header\nstring[] joint_names\n"
     "trajectory_msgs/JointTrajectoryPoint reference\n"
     "trajectory_msgs/JointTrajectoryPoint feedback\n"
     "trajectory_msgs/JointTrajectoryPoint error\n"
     "trajectory_msgs/JointTrajectoryPoint output\n"
     "trajectory_msgs/JointTrajectoryPoint desired\n"
     "trajectory_msgs/JointTrajectoryPoint actual\nstring[] multi_dof_joint_names\n"
     "trajectory_msgs/MultiDOFJointTrajectoryPoint multi_dof_reference\n"
     "trajectory_msgs/MultiDOFJointTrajectoryPoint multi_dof_feedback\n"
     "trajectory_msgs/MultiDOFJointTrajectoryPoint multi_dof_error\n"
     "trajectory_msgs/MultiDOFJointTrajectoryPoint multi_dof_output\n"
     "trajectory_msgs/MultiDOFJointTrajectoryPoint multi_dof_desired\n"
     "trajectory_msgs/MultiDOFJointTrajectoryPoint multi_dof_actual"},
    {"control_msgs/msg/PidState",
     "std_msgs/Header header\nbuiltin_interfaces/Duration timestep\nfloat64 error\n"
     "float64 error_dot\nfloat64 p_error\nfloat64 i_error\nfloat64 d_error\nfloat64 p_term\n"
     "float64 i_term\nfloat64 d_term\nfloat64 i_max\nfloat64 i_min\nfloat64 output"},

    {"diagnostic_msgs/msg/DiagnosticArray", "std_msgs/Header header\nDiagnosticStatus[] status"},
    {"diagnostic_msgs/msg/DiagnosticStatus",
     "byte level\nstring name\nstring message\nstring hardware_id\nKeyValue[] values"},
    {"diagnostic_msgs/msg/KeyValue", "string key\nstring value"},

    {"example_interfaces/msg/Bool", "bool data"},
    {"example_interfaces/msg/Byte", "byte data"},
    {"example_interfaces/msg/Char", "char data"},
    {"example_interfaces/msg/Empty", ""},
    {"example_interfaces/msg/Float32", "float32 data"},
    {"example_interfaces/msg/Float64", "float64 data"},
    {"example_interfaces/msg/Int16", "int16 data"},
    {"example_interfaces/msg/Int32", "int32 data"},
    {"example_interfaces/msg/Int64", "int64 data"},
    {"example_interfaces/msg/Int8", "int8 data"},
    {"example_interfaces/msg/String", "string data"},
    {"example_interfaces/msg/UInt16", "uint16 data"},
    {"example_interfaces/msg/UInt32", "uint32 data"},
    {"example_interfaces/msg/UInt64", "uint64 data"},
    {"example_interfaces/msg/UInt8", "uint8 data"},

    {"geographic_msgs/msg/GeoPoint", "float64 latitude\nfloat64 longitude\nfloat64 altitude"},
    {"geographic_msgs/msg/GeoPointStamped", "std_msgs/Header header\nGeoPoint position"},
    {"geographic_msgs/msg/GeoPose", "GeoPoint position\ngeometry_msgs/Quaternion orientation"},
    {"geographic_msgs/msg/GeoPoseStamped", "std_msgs/Header header\nGeoPose pose"},

    {"geometry_msgs/msg/Accel", "Vector3 linear\nVector3 angular"},
    {"geometry_msgs/msg/AccelStamped", "std_msgs/Header header\nAccel accel"},
    {"geometry_msgs/msg/AccelWithCovariance", "Accel accel\nfloat64[36] covariance"},
    {"geometry_msgs/msg/AccelWithCovarianceStamped",
     "std_msgs/Header header\nAccelWithCovariance accel"},
    {"geometry_msgs/msg/Inertia",
     "float64 m\nVector3 com\nfloat64 ixx\nfloat64 ixy\nfloat64 ixz\nfloat64 iyy\n"
     "float64 iyz\nfloat64 izz"},
    {"geometry_msgs/msg/InertiaStamped", "std_msgs/Header header\nInertia inertia"},
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

    {"nav2_msgs/action/FollowPath_Feedback", "float32 distance_to_goal\nfloat32 speed"},
    {"nav2_msgs/action/NavigateToPose_Feedback",
     "geometry_msgs/PoseStamped current_pose\nbuiltin_interfaces/Duration navigation_time\n"
     "builtin_interfaces/Duration estimated_time_remaining\nint16 number_of_recoveries\n"
     "float32 distance_remaining"},
    {"nav2_msgs/msg/BehaviorTreeLog",
     "builtin_interfaces/Time timestamp\nBehaviorTreeStatusChange[] event_log"},
    {"nav2_msgs/msg/BehaviorTreeStatusChange",
     "builtin_interfaces/Time timestamp\nstring node_name\nstring previous_status\n"
     "string current_status"},
    {"nav2_msgs/msg/Costmap", "std_msgs/Header header\nCostmapMetaData metadata\nuint8[] data"},
    {"nav2_msgs/msg/CostmapMetaData",
     "builtin_interfaces/Time map_load_time\nbuiltin_interfaces/Time update_time\n"
     "string layer\nfloat32 resolution\nuint32 size_x\nuint32 size_y\n"
     "geometry_msgs/Pose origin"},
    {"nav2_msgs/msg/Particle", "geometry_msgs/Pose pose\nfloat64 weight"},
    {"nav2_msgs/msg/ParticleCloud", "std_msgs/Header header\nParticle[] particles"},
    {"nav2_msgs/msg/SpeedLimit", "std_msgs/Header header\nbool percentage\nfloat64 speed_limit"},
    {"nav2_msgs/msg/VoxelGrid",
     "std_msgs/Header header\nuint32[] data\ngeometry_msgs/Point32 origin\n"
     "geometry_msgs/Vector3 resolutions\nuint32 size_x\nuint32 size_y\nuint32 size_z"},
    {"nav2_msgs/srv/ManageLifecycleNodes_Request", "uint8 command"},
    {"nav2_msgs/srv/ManageLifecycleNodes_Response", "bool success"},

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

    {"nmea_msgs/msg/Sentence", "std_msgs/Header header\nstring sentence"},

    {"px4_msgs/msg/OffboardControlMode",
     "uint64 timestamp\nbool position\nbool velocity\nbool acceleration\nbool attitude\n"
     "bool body_rate\nbool thrust_and_torque\nbool direct_actuator"},
    {"px4_msgs/msg/SensorCombined",
     "uint64 timestamp\nfloat32[3] gyro_rad\nuint32 gyro_integral_dt\n"
     "int32 accelerometer_timestamp_relative\nfloat32[3] accelerometer_m_s2\n"
     "uint32 accelerometer_integral_dt\nuint8 accelerometer_clipping\nuint8 gyro_clipping\n"
     "uint8 accel_calibration_count\nuint8 gyro_calibration_count"},
    {"px4_msgs/msg/TrajectorySetpoint",
     "uint64 timestamp\nfloat32[3] position\nfloat32[3] velocity\nfloat32[3] acceleration\n"
     "float32[3] jerk\nfloat32 yaw\nfloat32 yawspeed"},
    {"px4_msgs/msg/VehicleAngularVelocity",
     "uint64 timestamp\nuint64 timestamp_sample\nfloat32[3] xyz\nfloat32[3] xyz_derivative"},
    {"px4_msgs/msg/VehicleAttitude",
     "uint64 timestamp\nuint64 timestamp_sample\nfloat32[4] q\nfloat32[4] delta_q_reset\n"
     "uint8 quat_reset_counter"},
    {"px4_msgs/msg/VehicleOdometry",
     "uint64 timestamp\nuint64 timestamp_sample\nuint8 pose_frame\nfloat32[3] position\n"
     "float32[4] q\nuint8 velocity_frame\nfloat32[3] velocity\nfloat32[3] angular_velocity\n"
     "float32[3] position_variance\nfloat32[3] orientation_variance\n"
     "float32[3] velocity_variance\nuint8 reset_counter\nint8 quality"},

    {"rcl_interfaces/msg/Log",
     "builtin_interfaces/Time stamp\nuint8 level\nstring name\nstring msg\nstring file\n"
     "string function\nuint32 line"},
    {"rcl_interfaces/msg/Parameter", "string name\nParameterValue value"},
    {"rcl_interfaces/msg/ParameterEvent",
     "builtin_interfaces/Time stamp\nstring node\nParameter[] new_parameters\n"
     "Parameter[] changed_parameters\nParameter[] deleted_parameters"},
    {"rcl_interfaces/msg/ParameterValue",
     "uint8 type\nbool bool_value\nint64 integer_value\nfloat64 double_value\n"
     "string string_value\nbyte[] byte_array_value\nbool[] bool_array_value\n"
     "int64[] integer_array_value\nfloat64[] double_array_value\nstring[] string_array_value"},
    {"rcl_interfaces/msg/SetParametersResult", "bool successful\nstring reason"},
    {"rcl_interfaces/srv/SetParametersAtomically_Request", "Parameter[] parameters"},
    {"rcl_interfaces/srv/SetParametersAtomically_Response", "SetParametersResult result"},

    {"rosbag2_interfaces/msg/ReadSplitEvent", "string closed_file\nstring opened_file"},
    {"rosbag2_interfaces/msg/WriteSplitEvent", "string closed_file\nstring opened_file"},

    {"rosgraph_msgs/msg/Clock", "builtin_interfaces/Time clock"},

    {"sensor_msgs/msg/BatteryState",
     "std_msgs/Header header\nfloat32 voltage\nfloat32 temperature\nfloat32 current\n"
     "float32 charge\nfloat32 capacity\nfloat32 design_capacity\nfloat32 percentage\n"
     "uint8 power_supply_status\nuint8 power_supply_health\nuint8 power_supply_technology\n"
     "bool present\nfloat32[] cell_voltage\nfloat32[] cell_temperature\nstring location\n"
     "string serial_number"},
    {"sensor_msgs/msg/CameraInfo",
     "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\n"
     "float64[] d\nfloat64[9] k\nfloat64[9] r\nfloat64[12] p\nuint32 binning_x\n"
     "uint32 binning_y\nRegionOfInterest roi"},
    {"sensor_msgs/msg/ChannelFloat32", "string name\nfloat32[] values"},
    {"sensor_msgs/msg/CompressedImage", "std_msgs/Header header\nstring format\nuint8[] data"},
    {"sensor_msgs/msg/FluidPressure",
     "std_msgs/Header header\nfloat64 fluid_pressure\nfloat64 variance"},
    {"sensor_msgs/msg/Illuminance",
     "std_msgs/Header header\nfloat64 illuminance\nfloat64 variance"},
    {"sensor_msgs/msg/Image",
     "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\n"
     "uint8 is_bigendian\nuint32 step\nuint8[] data"},
    {"sensor_msgs/msg/Imu",
     "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\n"
     "float64[9] orientation_covariance\ngeometry_msgs/Vector3 angular_velocity\n"
     "float64[9] angular_velocity_covariance\ngeometry_msgs/Vector3 linear_acceleration\n"
     "float64[9] linear_acceleration_covariance"},
    {"sensor_msgs/msg/JointState",
     "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\n"
     "float64[] effort"},
    {"sensor_msgs/msg/Joy", "std_msgs/Header header\nfloat32[] axes\nint32[] buttons"},
    {"sensor_msgs/msg/JoyFeedback", "uint8 type\nuint8 id\nfloat32 intensity"},
    {"sensor_msgs/msg/JoyFeedbackArray", "JoyFeedback[] array"},
    {"sensor_msgs/msg/LaserEcho", "float32[] echoes"},
    {"sensor_msgs/msg/LaserScan",
     "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n"
     "float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\n"
     "float32[] ranges\nfloat32[] intensities"},
    {"sensor_msgs/msg/MagneticField",
     "std_msgs/Header header\ngeometry_msgs/Vector3 magnetic_field\n"
     "float64[9] magnetic_field_covariance"},
    {"sensor_msgs/msg/MultiDOFJointState",
     "std_msgs/Header header\nstring[] joint_names\ngeometry_msgs/Transform[] transforms\n"
     "geometry_msgs/Twist[] twist\ngeometry_msgs/Wrench[] wrench"},
    {"sensor_msgs/msg/MultiEchoLaserScan",
     "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n"
     "float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\n"
     "LaserEcho[] ranges\nLaserEcho[] intensities"},
    {"sensor_msgs/msg/NavSatFix",
     "std_msgs/Header header\nNavSatStatus status\nfloat64 latitude\nfloat64 longitude\n"
     "float64 altitude\nfloat64[9] position_covariance\nuint8 position_covariance_type"},
    {"sensor_msgs/msg/NavSatStatus", "int8 status\nuint16 service"},
    {"sensor_msgs/msg/PointCloud",
     "std_msgs/Header header\ngeometry_msgs/Point32[] points\nChannelFloat32[] channels"},
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

    {"shape_msgs/msg/Mesh", "MeshTriangle[] triangles\ngeometry_msgs/Point[] vertices"},
    {"shape_msgs/msg/MeshTriangle", "uint32[3] vertex_indices"},
    {"shape_msgs/msg/Plane", "float64[4] coef"},
    {"shape_msgs/msg/SolidPrimitive",
     "uint8 type\nfloat64[<=3] dimensions\ngeometry_msgs/Polygon polygon"},

    {"statistics_msgs/msg/MetricsMessage",
     "string measurement_source_name\nstring metrics_source\nstring unit\n"
     "builtin_interfaces/Time window_start\nbuiltin_interfaces/Time window_stop\n"
     "StatisticDataPoint[] statistics"},
    {"statistics_msgs/msg/StatisticDataPoint", "uint8 data_type\nfloat64 data"},

    {"std_msgs/msg/Bool", "bool data"},
    {"std_msgs/msg/Byte", "byte data"},
    {"std_msgs/msg/ByteMultiArray", "MultiArrayLayout layout\nbyte[] data"},
    {"std_msgs/msg/Char", "char data"},
    {"std_msgs/msg/ColorRGBA", "float32 r\nfloat32 g\nfloat32 b\nfloat32 a"},
    {"std_msgs/msg/Empty", ""},
    {"std_msgs/msg/Float32", "float32 data"},
    {"std_msgs/msg/Float32MultiArray", "MultiArrayLayout layout\nfloat32[] data"},
    {"std_msgs/msg/Float64", "float64 data"},
    {"std_msgs/msg/Float64MultiArray", "MultiArrayLayout layout\nfloat64[] data"},
    {"std_msgs/msg/Header", "builtin_interfaces/Time stamp\nstring frame_id"},
    {"std_msgs/msg/Int16", "int16 data"},
    {"std_msgs/msg/Int16MultiArray", "MultiArrayLayout layout\nint16[] data"},
    {"std_msgs/msg/Int32", "int32 data"},
    {"std_msgs/msg/Int32MultiArray", "MultiArrayLayout layout\nint32[] data"},
    {"std_msgs/msg/Int64", "int64 data"},
    {"std_msgs/msg/Int64MultiArray", "MultiArrayLayout layout\nint64[] data"},
    {"std_msgs/msg/Int8", "int8 data"},
    {"std_msgs/msg/Int8MultiArray", "MultiArrayLayout layout\nint8[] data"},
    {"std_msgs/msg/MultiArrayDimension", "string label\nuint32 size\nuint32 stride"},
    {"std_msgs/msg/MultiArrayLayout", "MultiArrayDimension[] dim\nuint32 data_offset"},
    {"std_msgs/msg/String", "string data"},
    {"std_msgs/msg/UInt16", "uint16 data"},
    {"std_msgs/msg/UInt16MultiArray", "MultiArrayLayout layout\nuint16[] data"},
    {"std_msgs/msg/UInt32", "uint32 data"},
    {"std_msgs/msg/UInt32MultiArray", "MultiArrayLayout layout\nuint32[] data"},
    {"std_msgs/msg/UInt64", "uint64 data"},
    {"std_msgs/msg/UInt64MultiArray", "MultiArrayLayout layout\nuint64[] data"},
    {"std_msgs/msg/UInt8", "uint8 data"},
    {"std_msgs/msg/UInt8MultiArray", "MultiArrayLayout layout\nuint8[] data"},

    {"std_srvs/srv/Empty_Request", ""},
    {"std_srvs/srv/Empty_Response", ""},
    {"std_srvs/srv/SetBool_Request", "bool data"},
    {"std_srvs/srv/SetBool_Response", "bool success\nstring message"},
    {"std_srvs/srv/Trigger_Request", ""},
    {"std_srvs/srv/Trigger_Response", "bool success\nstring message"},

    {"stereo_msgs/msg/DisparityImage",
     "std_msgs/Header header\nsensor_msgs/Image image\nfloat32 f\nfloat32 t\n"
     "sensor_msgs/RegionOfInterest valid_window\nfloat32 min_disparity\n"
     "float32 max_disparity\nfloat32 delta_d"},

    {"system_modes_msgs/msg/Mode", "string label"},
    {"system_modes_msgs/msg/ModeEvent", "uint64 timestamp\nMode start_mode\nMode goal_mode"},

    {"tf2_msgs/msg/TF2Error", "uint8 error\nstring error_string"},
    {"tf2_msgs/msg/TFMessage", "geometry_msgs/TransformStamped[] transforms"},

    {"trajectory_msgs/msg/JointTrajectory",
     "std_msgs/Header header\nstring[] joint_names\nJointTrajectoryPoint[] points"},
    {"trajectory_msgs/msg/JointTrajectoryPoint",
     "float64[] positions\nfloat64[] velocities\nfloat64[] accelerations\nfloat64[] effort\n"
     "builtin_interfaces/Duration time_from_start"},
    {"trajectory_msgs/msg/MultiDOFJointTrajectory",
     "std_msgs/Header header\nstring[] joint_names\nMultiDOFJointTrajectoryPoint[] points"},
    {"trajectory_msgs/msg/MultiDOFJointTrajectoryPoint",
     "geometry_msgs/Transform[] transforms\ngeometry_msgs/Twist[] velocities\n"
     "geometry_msgs/Twist[] accelerations\nbuiltin_interfaces/Duration time_from_start"},

    {"turtlesim/msg/Pose",
     "float32 x\nfloat32 y\nfloat32 theta\nfloat32 linear_velocity\nfloat32 angular_velocity"},

    {"unique_identifier_msgs/msg/UUID", "uint8[16] uuid"},

    {"vision_msgs/msg/BoundingBox2D", "Pose2D center\nfloat64 size_x\nfloat64 size_y"},
    {"vision_msgs/msg/BoundingBox3D", "geometry_msgs/Pose center\ngeometry_msgs/Vector3 size"},
    {"vision_msgs/msg/Detection2D",
     "std_msgs/Header header\nObjectHypothesisWithPose[] results\nBoundingBox2D bbox\n"
     "string id"},
    {"vision_msgs/msg/Detection2DArray", "std_msgs/Header header\nDetection2D[] detections"},
    {"vision_msgs/msg/Detection3D",
     "std_msgs/Header header\nObjectHypothesisWithPose[] results\nBoundingBox3D bbox\n"
     "string id"},
    {"vision_msgs/msg/Detection3DArray", "std_msgs/Header header\nDetection3D[] detections"},
    {"vision_msgs/msg/ObjectHypothesis", "string class_id\nfloat64 score"},
    {"vision_msgs/msg/ObjectHypothesisWithPose",
     "ObjectHypothesis hypothesis\ngeometry_msgs/PoseWithCovariance pose"},
    {"vision_msgs/msg/Point2D", "float64 x\nfloat64 y"},
    {"vision_msgs/msg/Pose2D", "Point2D position\nfloat64 theta"},

    {"visualization_msgs/msg/ImageMarker",
     "std_msgs/Header header\nstring ns\nint32 id\nint32 type\nint32 action\n"
     "geometry_msgs/Point position\nfloat32 scale\nstd_msgs/ColorRGBA outline_color\n"
     "uint8 filled\nstd_msgs/ColorRGBA fill_color\nbuiltin_interfaces/Duration lifetime\n"
     "geometry_msgs/Point[] points\nstd_msgs/ColorRGBA[] outline_colors"},
    {"visualization_msgs/msg/InteractiveMarker",
     "std_msgs/Header header\ngeometry_msgs/Pose pose\nstring name\nstring description\n"
     "float32 scale\nMenuEntry[] menu_entries\nInteractiveMarkerControl[] controls"},
    {"visualization_msgs/msg/InteractiveMarkerControl",
     "string name\ngeometry_msgs/Quaternion orientation\nuint8 orientation_mode\n"
     "uint8 interaction_mode\nbool always_visible\nMarker[] markers\n"
     "bool independent_marker_orientation\nstring description"},
    {"visualization_msgs/msg/InteractiveMarkerFeedback",
     "std_msgs/Header header\nstring client_id\nstring marker_name\nstring control_name\n"
     "uint8 event_type\ngeometry_msgs/Pose pose\nuint32 menu_entry_id\n"
     "geometry_msgs/Point mouse_point\nbool mouse_point_valid"},
    {"visualization_msgs/msg/InteractiveMarkerInit",
     "string server_id\nuint64 seq_num\nInteractiveMarker[] markers"},
    {"visualization_msgs/msg/InteractiveMarkerPose",
     "std_msgs/Header header\ngeometry_msgs/Pose pose\nstring name"},
    {"visualization_msgs/msg/InteractiveMarkerUpdate",
     "string server_id\nuint64 seq_num\nuint8 type\nInteractiveMarker[] markers\n"
     "InteractiveMarkerPose[] poses\nstring[] erases"},
    {"visualization_msgs/msg/Marker",
     "std_msgs/Header header\nstring ns\nint32 id\nint32 type\nint32 action\n"
     "geometry_msgs/Pose pose\ngeometry_msgs/Vector3 scale\nstd_msgs/ColorRGBA color\n"
     "builtin_interfaces/Duration lifetime\nbool frame_locked\ngeometry_msgs/Point[] points\n"
     "std_msgs/ColorRGBA[] colors\nstring texture_resource\n"
     "sensor_msgs/CompressedImage texture\nUVCoordinate[] uv_coordinates\nstring text\n"
     "string mesh_resource\nMeshFile mesh_file\nbool mesh_use_embedded_materials"},
    {"visualization_msgs/msg/MarkerArray", "Marker[] markers"},
    {"visualization_msgs/msg/MenuEntry",
     "uint32 id\nuint32 parent_id\nstring title\nstring command\nuint8 command_type"},
    {"visualization_msgs/msg/MeshFile", "string filename\nuint8[] data"},
    {"visualization_msgs/msg/UVCoordinate", "float32 u\nfloat32 v"},
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
