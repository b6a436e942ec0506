"""URDF (http://wiki.ros.org/urdf/XML), with what Drake, Bullet and ROS add to it."""

from __future__ import annotations

from substructures.interchange.known.check import Vocabulary

URDF = Vocabulary.read(r"""
/robot: name version
robot/link: name type
robot/joint: name type
robot/transmission: name type
robot/material: name
robot/frame: name link xyz rpy
robot/gazebo|ros2_control|mujoco|sensor|collision_filter_group: *
robot/linear_bushing_rpy|ball_constraint|loop_joint|loop: *
link/inertial:
link/visual|collision: name group
link/contact|sensor|self_collision_checking|gravity: *
inertial|visual|collision|joint/origin: xyz rpy quat_xyzw
inertial/mass: value
inertial/inertia: ixx ixy ixz iyy iyz izz
visual|collision/geometry: name
visual|collision/proximity_properties|illustration_properties|perception_properties|accepting_renderer|verbose: *
visual|collision/contact_coefficients|capsule|declare_convex: *
geometry/box: size
geometry/sphere: radius
geometry/cylinder|capsule|cone: radius length
geometry/ellipsoid: radii axes a b c
geometry/plane: normal
geometry/mesh: filename scale name
mesh/declare_convex:
visual|collision/material: name
material/color: rgba
material/texture: filename
joint/parent|child: link
joint/axis: xyz
joint/limit: lower upper effort velocity acceleration deceleration jerk
joint/dynamics: damping friction
joint/mimic: joint multiplier offset
joint/calibration: rising falling reference_position
joint/safety_controller: soft_lower_limit soft_upper_limit k_position k_velocity
transmission/type:
transmission/joint|passive_joint|gap_joint|simulated_actuated_joint: *
transmission/actuator|leftActuator|rightActuator: name
transmission/flexJoint|rollJoint|compensator|use_simulated_gripper_joint: *
transmission|actuator|leftActuator|rightActuator/mechanicalReduction|mechanical_reduction:
actuator/rotor_inertia|gear_ratio: value
actuator/hardwareInterface|motorTorqueConstant|pulsesPerRevolution|role|controller_gains: *
leftActuator|rightActuator/hardwareInterface: *
transmission/motorTorqueConstant|pulsesPerRevolution|simulated_reduction|offset|hardwareInterface: *
""")
