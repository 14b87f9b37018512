within GiveWay.Parameters;
record Trikey "Numbers of Trikey, made from robots/trikey.toml"
  extends Modelica.Icons.Record;
  import Modelica.Units.SI;
  parameter SI.Mass base_mass=34.7 "sourced, medium confidence; wheels included; range 34-48";
  parameter SI.Inertia base_yaw_inertia=1.31 "sourced, medium confidence; wheels included";
  parameter SI.Length base_com_height=0.414 "sourced, medium confidence; above the floor";
  parameter SI.Inertia base_tilt_inertia=2.0 "sourced, medium confidence; about a horizontal axis through the centre of mass, wheels included";
  parameter SI.Length wheel_radius=0.1016 "sourced, high confidence; 4 in";
  parameter SI.Length wheel_distance=0.24 "sourced, medium confidence; R, centre of the base to the wheel";
  parameter SI.Inertia wheel_inertia=0.002798 "sourced, medium confidence; about the axle";
  parameter SI.Length wheel_width=0.025 "sourced, medium confidence; along the axle";
  parameter SI.TranslationalSpringConstant wheel_floor_stiffness=200000.0 "assumed, low confidence; vertical, of one wheel with its frame and the floor; deflection under the robot's weight 0.6 mm";
  parameter Real wheel_floor_damping(unit="s/m")=2.0 "assumed, low confidence; Hunt-Crossley; about a tenth of critical under the robot's weight";
  parameter Real wheel_grip_friction(unit="1")=0.7 "assumed, low confidence; polyurethane rollers on a hard floor";
  parameter SI.TranslationalSpringConstant wheel_grip_stiffness=2000000.0 "assumed, low confidence; along the rolling direction; the drivetrain is 30 times as soft";
  parameter SI.TranslationalDampingConstant wheel_grip_damping=400.0 "assumed, low confidence; a third of critical for the wheel's own inertia";
  parameter SI.Length roller_radius=0.009525 "sourced, medium confidence; 0.75 in roller";
  parameter SI.Inertia roller_inertia=1.23e-06 "sourced, low confidence; only the roller on the floor turns";
  parameter SI.Torque roller_coulomb_torque=0.2 "given, high confidence; B_r of (28)";
  parameter Real roller_tanh_slope(unit="s/rad")=0.4 "given, high confidence; alpha of (28)";
  parameter SI.TranslationalSpringConstant roller_presliding_stiffness=28900.0 "fitted, low confidence; sigma_0 per wheel at the floor; 16-67 kN/m reproduce the errors of 5.1";
  parameter SI.TranslationalDampingConstant roller_presliding_damping=20.0 "assumed, low confidence; sigma_1 per wheel";
  parameter SI.Velocity roller_stribeck_speed=0.0025 "assumed, low confidence; speed scale over which stiction gives way to (28)";
  parameter Real roller_elastic_fraction(unit="1")=0.7 "assumed, low confidence; rho_ba: share of the sliding deflection that is purely elastic";
  parameter Integer roller_rows=2 "assumed, low confidence; two staggered rows, as on most 4 in omniwheels";
  parameter Integer roller_per_row=9 "assumed, low confidence; 18 rollers in both rows";
  parameter SI.Length roller_row_distance=0.0125 "assumed, low confidence; half of the wheel's width: two rows side by side";
  parameter SI.Length roller_radius_dip=0.0001 "assumed, low confidence; the wheel's radius between two rollers; moulded rollers and their bearings have that much play";
  parameter Real roller_friction_scatter(unit="1")=0.1 "assumed, low confidence; from roller to roller, to both sides";
  parameter SI.Inertia drivetrain_motor_inertia=0.0523 "sourced, low confidence";
  parameter SI.RotationalSpringConstant drivetrain_stiffness=721.0 "fitted, low confidence; series of gear, sensor and belt; component estimates give 840";
  parameter SI.RotationalDampingConstant drivetrain_damping=1.0 "assumed, low confidence; about 3 % of critical for the base on its three drivetrains";
  parameter SI.Torque drivetrain_gear_coulomb=2.75 "fitted, low confidence; B1 while turning; range 1-5";
  parameter SI.Torque drivetrain_gear_stiction=2.75 "fitted, low confidence; B1 at rest";
  parameter SI.RotationalDampingConstant drivetrain_gear_viscous=0.02 "assumed, low confidence";
  parameter SI.Torque drivetrain_torque_limit=20.0 "assumed, low confidence; about 9 A through 43.3 mN m/A and 50:1";
  parameter SI.Torque drivetrain_torque_sensor_limit=28.0 "sourced, medium confidence; usable range to either side";
  parameter SI.Torque drivetrain_torque_sensor_resolution=0.0143 "sourced, medium confidence";
  parameter SI.Torque drivetrain_torque_noise=0.03 "assumed, low confidence; standard deviation at 1 kHz; range 0.01-0.1";
  parameter Integer drivetrain_encoder_counts=8500 "sourced, medium confidence; counts per wheel turn";
  parameter SI.RotationalSpringConstant servo_kp=189.0 "fitted, low confidence";
  parameter SI.RotationalDampingConstant servo_kd=7.02 "fitted, low confidence";
  parameter SI.Frequency servo_derivative_cutoff=60.0 "assumed, low confidence; first-order filter of the speed from encoder counts";
  parameter Integer electronics_bus_delay=1 "given, high confidence; cycles, each way";
  parameter SI.Length imu_height=0.414 "assumed, low confidence; at the height of the centre of mass, where it shows the sum of all forces although the body leans";
  parameter SI.Acceleration imu_acceleration_noise=0.0136 "assumed, medium confidence; in 250 Hz of first order; its zero is off by typically 20 mg, its scale by 0.5 %";
  parameter Real imu_gyro_noise(unit="rad/s")=0.00097 "assumed, medium confidence; in 250 Hz of first order; its zero is off by typically 0.5 deg/s, its scale by 0.5 %";
  parameter SI.Acceleration imu_vibration=0.01 "assumed, low confidence; fans, people walking by";
  parameter Real imu_vibration_growth(unit="s/rad")=6.0 "assumed, low confidence; rollers passing the floor shake it by 0.07 m/s2 at 0.16 m/s; floors with joints by more";
  parameter SI.Frequency imu_vibration_frequency=60.0 "assumed, low confidence; frame of aluminium profiles with batteries on a deck";
  parameter Real imu_vibration_damping(unit="1")=0.05 "assumed, low confidence; bolted frame";
  parameter SI.Frequency imu_bandwidth=250.0 "assumed, medium confidence";
  parameter SI.Acceleration imu_range=39.2266 "assumed, medium confidence";
  parameter Real imu_gyro_range(unit="rad/s")=8.7266 "assumed, medium confidence";
  parameter Integer imu_delay=1 "assumed, medium confidence; bus cycles, as the torque sensors; the filter's own delay of 0.6 ms is in the filter";
  parameter SI.Length outline_x[3]={0.352184, -0.176092, -0.176092} "given, high confidence; counter-clockwise";
  parameter SI.Length outline_y[3]={0.0, 0.305, -0.305} "given, high confidence";
  parameter SI.Length outline_clearance=0.101 "sourced, low confidence; lowest height of the body above the floor";
  parameter SI.Mass admittance_mass=2.0 "given, high confidence; M_des";
  parameter SI.TranslationalDampingConstant admittance_damping=1.6 "given, high confidence; B_des";
  parameter SI.Impulse admittance_escape_impulse=0.8 "given, medium confidence; escape distance 0.5 m = 0.8/1.6";
  parameter SI.Velocity admittance_speed_limit=0.5 "sourced, medium confidence";
  parameter SI.Acceleration admittance_acceleration_limit=2.8 "sourced, medium confidence";
  parameter SI.Impulse detector_impulse_threshold=1.71 "fitted, low confidence";
  parameter SI.Force detector_leak_rest=1.0 "assumed, low confidence; F0 at rest";
  parameter SI.Force detector_leak_motion=3.0 "assumed, low confidence; F0 in motion: the error of the roller friction model";
  parameter SI.Mass slider_mass=9.08 "given, high confidence; whole sliding mass";
  parameter SI.Force slider_friction=1.0 "assumed, low confidence; Coulomb friction of the rail";
  parameter SI.TranslationalDampingConstant slider_damping=0.0 "assumed, low confidence";
  parameter SI.Length slider_run_up=0.0395 "fitted, medium confidence; without friction and with a stiff rope 0.0382";
  parameter SI.Mass rope_hanging_mass=4.54 "given, high confidence";
  parameter SI.TranslationalSpringConstant rope_stiffness=10000.0 "assumed, low confidence";
  parameter SI.TranslationalDampingConstant rope_damping=150.0 "assumed, low confidence";
  parameter SI.Length rope_drop_height=0.2 "assumed, low confidence; the weight lands after this drop";
  parameter SI.Mass bumper_plate_mass=0.5 "assumed, low confidence; cover and plate, moving with the spring";
  parameter SI.TranslationalSpringConstant bumper_spring_rate=948.0 "fitted, low confidence";
  parameter SI.Force bumper_preload=2.0 "assumed, low confidence";
  parameter SI.TranslationalDampingConstant bumper_damping=5.0 "assumed, low confidence";
  parameter SI.Force bumper_guide_friction=0.5 "assumed, low confidence";
  parameter SI.Length bumper_travel=0.12 "assumed, low confidence; at least 0.12 m is needed at 0.5 m/s";
  parameter SI.Force bumper_latch_force=45.8 "fitted, low confidence; tolerance +-30 %, -0.24 %/K";
  parameter SI.Length bumper_latch_gap=0.001 "sourced, medium confidence; g0 of F_L/(1+g/g0)^2";
  parameter SI.TranslationalSpringConstant contact_stiffness=10100.0 "fitted, low confidence; polyurethane cover; 1e4-1e5";
  parameter Real contact_damping(unit="s/m")=0.3 "assumed, low confidence; Hunt-Crossley";
  annotation (
    Documentation(info="<html>
<p>Made from robots/trikey.toml by <code>python -m giveway_modelica record</code>: not to be edited.
Given: printed in the paper; sourced: found elsewhere; fitted: to the paper's results; assumed: estimated.</p>
<table border=\"1\">
<tr><th>number</th><th>unit</th><th>provenance</th><th>source</th></tr>
<tr><td>base_mass</td><td>kg</td><td>sourced</td><td>CentralLabFacilities/controlit_models@275dce2, trikey_base.xacro and omni_wheel.xacro (2015); 32.7 + 3 x 0.666</td></tr>
<tr><td>base_yaw_inertia</td><td>kg.m2</td><td>sourced</td><td>CentralLabFacilities/controlit_models@275dce2, trikey_base.xacro and omni_wheel.xacro (2015); 1.192 + 3 x 0.666 x 0.24^2</td></tr>
<tr><td>base_com_height</td><td>m</td><td>sourced</td><td>CentralLabFacilities/controlit_models@275dce2, trikey_base.xacro and omni_wheel.xacro (2015)</td></tr>
<tr><td>base_tilt_inertia</td><td>kg.m2</td><td>sourced</td><td>CentralLabFacilities/controlit_models@275dce2, trikey_base.xacro and omni_wheel.xacro (2015); 1.747 + 3 x 0.666 x 0.3124^2 + 1.5 x 0.666 x 0.24^2</td></tr>
<tr><td>wheel_radius</td><td>m</td><td>sourced</td><td>lsentis/uta-wbc-dreamer@87b153a (HCRL, 2011-2013) constraint_library.cpp</td></tr>
<tr><td>wheel_distance</td><td>m</td><td>sourced</td><td>CentralLabFacilities/controlit_models@275dce2, trikey_base.xacro and omni_wheel.xacro (2015)</td></tr>
<tr><td>wheel_inertia</td><td>kg.m2</td><td>sourced</td><td>CentralLabFacilities/controlit_models@275dce2, trikey_base.xacro and omni_wheel.xacro (2015)</td></tr>
<tr><td>wheel_width</td><td>m</td><td>sourced</td><td>CentralLabFacilities/controlit_models@275dce2, omni_wheel.xacro (2015): collision cylinder</td></tr>
<tr><td>wheel_floor_stiffness</td><td>N/m</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>wheel_floor_damping</td><td>s/m</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>wheel_grip_friction</td><td>1</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>wheel_grip_stiffness</td><td>N/m</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>wheel_grip_damping</td><td>N.s/m</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>roller_radius</td><td>m</td><td>sourced</td><td>carlosiglezb/trikey_description@9900a6c (successor robot, same wheel size)</td></tr>
<tr><td>roller_inertia</td><td>kg.m2</td><td>sourced</td><td>CentralLabFacilities/controlit_models@275dce2, trikey_base.xacro and omni_wheel.xacro (2015)</td></tr>
<tr><td>roller_coulomb_torque</td><td>N.m</td><td>given</td><td>Kim, Llado, Sentis, Auton Robot 40:325 (2016), 4.2</td></tr>
<tr><td>roller_tanh_slope</td><td>s/rad</td><td>given</td><td>Kim, Llado, Sentis, Auton Robot 40:325 (2016), 4.2</td></tr>
<tr><td>roller_presliding_stiffness</td><td>N/m</td><td>fitted</td><td>giveway fit, to the results of Kim, Llado, Sentis, Auton Robot 40:325 (2016); residuals in trikey.fit.json</td></tr>
<tr><td>roller_presliding_damping</td><td>N.s/m</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>roller_stribeck_speed</td><td>m/s</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>roller_elastic_fraction</td><td>1</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>roller_rows</td><td>1</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>roller_per_row</td><td>1</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>roller_row_distance</td><td>m</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>roller_radius_dip</td><td>m</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>roller_friction_scatter</td><td>1</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>drivetrain_motor_inertia</td><td>kg.m2</td><td>sourced</td><td>rotor 2.09e-5 kg m2 (lsentis/uta-wbc-dreamer@87b153a (HCRL, 2011-2013)) x 50^2 (ratio estimated)</td></tr>
<tr><td>drivetrain_stiffness</td><td>N.m/rad</td><td>fitted</td><td>giveway fit, to the results of Kim, Llado, Sentis, Auton Robot 40:325 (2016); residuals in trikey.fit.json</td></tr>
<tr><td>drivetrain_damping</td><td>N.m.s/rad</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>drivetrain_gear_coulomb</td><td>N.m</td><td>fitted</td><td>giveway fit, to the results of Kim, Llado, Sentis, Auton Robot 40:325 (2016); residuals in trikey.fit.json</td></tr>
<tr><td>drivetrain_gear_stiction</td><td>N.m</td><td>fitted</td><td>giveway fit, to the results of Kim, Llado, Sentis, Auton Robot 40:325 (2016); residuals in trikey.fit.json</td></tr>
<tr><td>drivetrain_gear_viscous</td><td>N.m.s/rad</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>drivetrain_torque_limit</td><td>N.m</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>drivetrain_torque_sensor_limit</td><td>N.m</td><td>sourced</td><td>17.76 N m/V (lsentis/uta-wbc-dreamer@87b153a (HCRL, 2011-2013)), 3.3 V converter with its zero at 1.6 V</td></tr>
<tr><td>drivetrain_torque_sensor_resolution</td><td>N.m</td><td>sourced</td><td>same scale, 12 bit</td></tr>
<tr><td>drivetrain_torque_noise</td><td>N.m</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>drivetrain_encoder_counts</td><td>1</td><td>sourced</td><td>carlosiglezb/trikey_control@00a9eea</td></tr>
<tr><td>servo_kp</td><td>N.m/rad</td><td>fitted</td><td>giveway fit, to the results of Kim, Llado, Sentis, Auton Robot 40:325 (2016); residuals in trikey.fit.json</td></tr>
<tr><td>servo_kd</td><td>N.m.s/rad</td><td>fitted</td><td>giveway fit, to the results of Kim, Llado, Sentis, Auton Robot 40:325 (2016); residuals in trikey.fit.json</td></tr>
<tr><td>servo_derivative_cutoff</td><td>Hz</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>electronics_bus_delay</td><td>1</td><td>given</td><td>Kim, Llado, Sentis, Auton Robot 40:325 (2016), Fig. 3 (1 ms EtherCAT cycle)</td></tr>
<tr><td>imu_height</td><td>m</td><td>assumed</td><td>assumed equipment: Trikey has no accelerometer</td></tr>
<tr><td>imu_acceleration_noise</td><td>m/s2</td><td>assumed</td><td>TDK InvenSense DS-000347 v1.7, ICM-42688-P: 70 ug/sqrt(Hz)</td></tr>
<tr><td>imu_gyro_noise</td><td>rad/s</td><td>assumed</td><td>TDK InvenSense DS-000347 v1.7, ICM-42688-P: 2.8 mdeg/s/sqrt(Hz)</td></tr>
<tr><td>imu_vibration</td><td>m/s2</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>imu_vibration_growth</td><td>s/rad</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>imu_vibration_frequency</td><td>Hz</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>imu_vibration_damping</td><td>1</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>imu_bandwidth</td><td>Hz</td><td>assumed</td><td>TDK InvenSense DS-000347 v1.7, ICM-42688-P: low-pass filter at a quarter of the data rate of 1 kHz</td></tr>
<tr><td>imu_range</td><td>m/s2</td><td>assumed</td><td>TDK InvenSense DS-000347 v1.7, ICM-42688-P: 4 g of 2, 4, 8, 16</td></tr>
<tr><td>imu_gyro_range</td><td>rad/s</td><td>assumed</td><td>TDK InvenSense DS-000347 v1.7, ICM-42688-P: 500 deg/s of 15.6 to 2000</td></tr>
<tr><td>imu_delay</td><td>1</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>outline_x</td><td>m</td><td>given</td><td>Kim, Llado, Sentis, Auton Robot 40:325 (2016), 5.1 (61 cm side)</td></tr>
<tr><td>outline_y</td><td>m</td><td>given</td><td>Kim, Llado, Sentis, Auton Robot 40:325 (2016), 5.1 (61 cm side)</td></tr>
<tr><td>outline_clearance</td><td>m</td><td>sourced</td><td>CentralLabFacilities/controlit_models@275dce2, trikey_base.xacro (2015): lower end of the collision cylinder</td></tr>
<tr><td>admittance_mass</td><td>kg</td><td>given</td><td>Kim, Llado, Sentis, Auton Robot 40:325 (2016), 5.2</td></tr>
<tr><td>admittance_damping</td><td>N.s/m</td><td>given</td><td>Kim, Llado, Sentis, Auton Robot 40:325 (2016), 5.2 (printed N/m^2)</td></tr>
<tr><td>admittance_escape_impulse</td><td>N.s</td><td>given</td><td>Kim, Llado, Sentis, Auton Robot 40:325 (2016), 5.2 (printed N)</td></tr>
<tr><td>admittance_speed_limit</td><td>m/s</td><td>sourced</td><td>lsentis/uta-wbc-dreamer@87b153a (HCRL, 2011-2013)</td></tr>
<tr><td>admittance_acceleration_limit</td><td>m/s2</td><td>sourced</td><td>tip limit g (R/2)/h of the base</td></tr>
<tr><td>detector_impulse_threshold</td><td>N.s</td><td>fitted</td><td>giveway fit, to the results of Kim, Llado, Sentis, Auton Robot 40:325 (2016); residuals in trikey.fit.json</td></tr>
<tr><td>detector_leak_rest</td><td>N</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>detector_leak_motion</td><td>N</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>slider_mass</td><td>kg</td><td>given</td><td>Kim, Llado, Sentis, Auton Robot 40:325 (2016), 5.2</td></tr>
<tr><td>slider_friction</td><td>N</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>slider_damping</td><td>N.s/m</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>slider_run_up</td><td>m</td><td>fitted</td><td>giveway fit, to the results of Kim, Llado, Sentis, Auton Robot 40:325 (2016); residuals in trikey.fit.json</td></tr>
<tr><td>rope_hanging_mass</td><td>kg</td><td>given</td><td>Kim, Llado, Sentis, Auton Robot 40:325 (2016), 5.2</td></tr>
<tr><td>rope_stiffness</td><td>N/m</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>rope_damping</td><td>N.s/m</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>rope_drop_height</td><td>m</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>bumper_plate_mass</td><td>kg</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>bumper_spring_rate</td><td>N/m</td><td>fitted</td><td>giveway fit, to the results of Kim, Llado, Sentis, Auton Robot 40:325 (2016); residuals in trikey.fit.json</td></tr>
<tr><td>bumper_preload</td><td>N</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>bumper_damping</td><td>N.s/m</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>bumper_guide_friction</td><td>N</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>bumper_travel</td><td>m</td><td>assumed</td><td>engineering estimate</td></tr>
<tr><td>bumper_latch_force</td><td>N</td><td>fitted</td><td>giveway fit, to the results of Kim, Llado, Sentis, Auton Robot 40:325 (2016); residuals in trikey.fit.json</td></tr>
<tr><td>bumper_latch_gap</td><td>m</td><td>sourced</td><td>magnet vendors state half the force at 0.5 mm</td></tr>
<tr><td>contact_stiffness</td><td>N/m</td><td>fitted</td><td>giveway fit, to the results of Kim, Llado, Sentis, Auton Robot 40:325 (2016); residuals in trikey.fit.json</td></tr>
<tr><td>contact_damping</td><td>s/m</td><td>assumed</td><td>engineering estimate</td></tr>
</table>
</html>"));
end Trikey;
