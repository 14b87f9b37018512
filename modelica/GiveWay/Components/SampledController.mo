within GiveWay.Components;
block SampledController "Estimator, detector and admittance of the paper, sampled at 1 kHz: the FMU's preset paper"
  import Modelica.Units.SI;
  parameter Parameters.Trikey robot "The robot's parameters";
  parameter SI.Time period=0.001 "Sample period";
  parameter Integer counts=robot.drivetrain_encoder_counts "Encoder counts per turn";
  parameter SI.Torque resolution=robot.drivetrain_torque_sensor_resolution "Resolution of the torque signal";
  parameter Boolean motor_current=false "The torque signal is that of the motors' currents";
  parameter Integer tare_ticks=100 "Samples of the initial tare; 0: no tare, the robot follows its plan from the start";
  parameter Integer rest_ticks=300 "Samples of slow planned motion until the robot counts as standing";
  parameter Integer retare_ticks=100 "Samples of the tare after a stop";
  parameter SI.Torque tare_variation=0.5 "Largest variation of the torques during a tare";
  parameter SI.Velocity rest_speed=0.002 "Planned speed below which the robot may count as standing";
  parameter SI.Velocity creep_speed=0.03 "Planned speed above which the rollers slide steadily";
  parameter SI.Force leak_rest=robot.detector_leak_rest
    "Leak of the detector at rest: error of the estimate that is tolerated";
  parameter SI.Force leak_creep=42 "The same while creeping: the force that two stuck rollers can hold";
  parameter SI.Force leak_motion=robot.detector_leak_motion "The same in motion";
  parameter SI.Impulse threshold=robot.detector_impulse_threshold "Impulse that counts as a hit";
  parameter SI.Force release=6 "Mean force below which the next hit can be noticed";
  parameter Integer blanking_ticks=300 "Samples after a hit during which no other hit is noticed";
  parameter SI.Velocity settled_speed=0.005 "Speed below which the escape is over";
  parameter Integer settled_ticks=500 "Quiet samples until the escape is over";
  parameter SI.Velocity finish_speed=0.01 "Lowest speed before the end of the escape and of the return";
  parameter SI.Velocity rejoin_speed=0.1 "Largest speed of the return to the plan";
  parameter SI.Distance rejoin_distance=0.0002 "Distance from the plan at which the return is over";
  parameter SI.Acceleration plan_acceleration=1.5 "Acceleration limit of the reference along the plan";
  parameter Real follow(unit="1/s")=2 "Gain towards the plan";
  parameter SI.Velocity follow_free=0.001 "Negligible correction towards the plan";
  parameter SI.Angle phi_start[3]=zeros(3) "Motor angles at the start";
  parameter SI.AngularVelocity w_start[3]=zeros(3) "Wheel speeds at the start";
  parameter SI.Torque tau_start[3]=zeros(3) "Torque signal at the start";
  constant SI.Angle turn=6.283185307179586 "One turn";
  constant Integer window=20 "Samples of the moving average";
  final parameter SI.Mass m_roll=1.5*(robot.wheel_inertia/robot.wheel_radius^2
    + robot.roller_inertia/robot.roller_radius^2) "Mass of wheels and rollers in (27)";
  final parameter SI.Inertia I_roll=robot.base_yaw_inertia
    + 3*robot.wheel_inertia*(robot.wheel_distance/robot.wheel_radius)^2 "Yaw inertia including the wheels' rotation";
  final parameter Real rate(unit="1/s")=robot.admittance_damping/robot.admittance_mass "Inverse time constant of (2)";
  final parameter SI.Length escape=robot.admittance_escape_impulse/robot.admittance_damping "Length of the escape (47)";
  Interfaces.TorqueInput tau_s[3] "Sensed torques"
    annotation (Placement(transformation(extent={{-110,17},{-90,37}})));
  Interfaces.TorqueInput tau_m[3] "Torques of the motors, held by their servos"
    annotation (Placement(transformation(extent={{-110,-10},{-90,10}})));
  Interfaces.AngleInput phi_m[3] "Motor angles"
    annotation (Placement(transformation(extent={{-110,-37},{-90,-17}})));
  input SI.Position plan_x[2] "Planned position at the path time, world frame";
  input SI.Velocity plan_v[2] "Planned velocity";
  input SI.Acceleration plan_a[2] "Planned acceleration";
  input SI.Angle plan_theta "Planned heading";
  output SI.Time path_time "Path time of the plan";
  Interfaces.AngleOutput phi_ref[3] "Wanted wheel angles"
    annotation (Placement(transformation(extent={{90,17},{110,37}})));
  Interfaces.AngularVelocityOutput w_ref[3] "Wanted wheel speeds"
    annotation (Placement(transformation(extent={{90,-37},{110,-17}})));
  discrete Integer tick(start=-1, fixed=true) "Samples taken";
  discrete Integer path_ticks(start=0, fixed=true) "Samples of the plan's clock, which stands still during an escape";
  discrete SI.Torque signal[3](each start=0, each fixed=true) "Torque signal of this sample, before it is rounded";
  discrete SI.Torque tau_now[3](start={resolution*floor(tau_start[i]/resolution + 0.5) for i in 1:3}, each fixed=true)
    "Torques of this sample, on the bus";
  discrete SI.Torque tau[3](each start=0, each fixed=true) "Torques as they arrive";
  discrete SI.Angle phi_now[3](start={floor((phi_start[i] - w_start[i]*period)/turn*counts)*turn/counts for i in 1:3},
    each fixed=true) "Encoder angles of this sample, on the bus";
  discrete SI.Velocity speed(start=0, fixed=true)
    "Speed of the reference before this sample: the faster of base and wheels";
  discrete Integer slow_ticks(start=0, fixed=true) "Samples of slow planned motion";
  discrete Boolean first_tare(start=false, fixed=true) "The initial tare uses this sample";
  discrete Boolean stop_tare(start=false, fixed=true) "The tare after a stop uses this sample";
  discrete Integer tares(start=0, fixed=true) "Samples in the running tare";
  discrete SI.Torque tare_sum[3](each start=0, each fixed=true) "Sums of the running tare";
  discrete SI.Torque tare_low[3](each start=1e9, each fixed=true) "Minima of the running tare";
  discrete SI.Torque tare_high[3](each start=-1e9, each fixed=true) "Maxima of the running tare";
  discrete Boolean tare_bad(start=false, fixed=true) "The torques vary too much for a tare";
  discrete Boolean tare_done(start=false, fixed=true) "A tare ends with this sample";
  discrete SI.Torque zero[3](each start=0, each fixed=true) "Torques of the last tare";
  discrete SI.Torque zero_first[3](each start=0, each fixed=true) "Torques of the initial tare";
  discrete Boolean stands(start=true, fixed=true) "The robot stands and was tared: T|0 is the tare";
  discrete Boolean zero_changed(start=false, fixed=true) "The tare changed with this sample";
  discrete SI.Velocity v_model[2](each start=0, each fixed=true) "Velocity of T|0, base axes";
  discrete SI.AngularVelocity omega_model(start=0, fixed=true) "Yaw rate of T|0";
  discrete SI.Acceleration a_model[2](each start=0, each fixed=true) "Acceleration of T|0, base axes";
  discrete SI.AngularAcceleration alpha_model(start=0, fixed=true) "Yaw acceleration of T|0";
  discrete SI.Torque tau_zero[3](each start=0, each fixed=true) "Torques of T|0 without motion";
  discrete SI.Force F[2](each start=0, each fixed=true) "Estimated external force, base axes";
  discrete SI.Torque M_z(start=0, fixed=true) "Estimated external moment";
  discrete Integer samples(start=0, fixed=true) "Estimates in the moving average";
  discrete SI.Force past_x[window](each start=0, each fixed=true) "Last estimates";
  discrete SI.Force past_y[window](each start=0, each fixed=true) "Last estimates";
  discrete SI.Force mean_sum[2](each start=0, each fixed=true) "Sum of the last estimates, base axes";
  discrete SI.Force mean(start=0, fixed=true) "Magnitude of their mean";
  discrete SI.Force leak(start=0, fixed=true) "Present leak of the detector";
  discrete Boolean noticed(start=false, fixed=true) "A hit was noticed, and its effects still last";
  discrete Integer noticed_ticks(start=0, fixed=true) "Samples since then";
  discrete Boolean lasts(start=false, fixed=true) "The effects still last before this sample is judged";
  discrete Boolean judged(start=false, fixed=true) "This sample can be a hit";
  discrete SI.Impulse p_sum[2](each start=0, each fixed=true) "Impulse before its leak, base axes";
  discrete SI.Impulse length(start=0, fixed=true) "Its magnitude";
  discrete SI.Impulse left(start=0, fixed=true) "Its magnitude after the leak: the statistic";
  discrete SI.Impulse p[2](each start=0, each fixed=true) "Impulse after the leak, base axes";
  discrete SI.AngularImpulse moment_sum(start=0, fixed=true) "Impulse of the moment before its leak";
  discrete SI.AngularImpulse moment(start=0, fixed=true) "Impulse of the moment after the leak";
  discrete Boolean hit(start=false, fixed=true) "A hit is noticed in this sample";
  discrete Integer hits(start=0, fixed=true) "Hits noticed so far";
  discrete Integer hit_tick(start=-1, fixed=true) "Sample of the last one";
  discrete SI.Position hit_arm(start=0, fixed=true) "Lever arm of the last hit";
  discrete SI.Position hit_point[2](each start=0, each fixed=true)
    "Contact point of the last hit on the outline, base frame";
  discrete Integer mode(start=1, fixed=true)
    "1 taring, 2 on the plan, 3 giving way, 4 settled, 5 returning to the plan";
  discrete Integer quiet_ticks(start=0, fixed=true) "Quiet samples of the escape";
  discrete Boolean placed(start=false, fixed=true) "The reference is on its plan";
  discrete Boolean placing(start=false, fixed=true) "The reference is put on its plan with this sample";
  discrete Boolean following(start=false, fixed=true) "The reference follows its plan in this sample";
  discrete Boolean escaping(start=false, fixed=true) "The reference escapes in this sample";
  discrete Boolean returning(start=false, fixed=true) "The reference returns to its plan in this sample";
  discrete Boolean returned(start=false, fixed=true) "The reference is back on its plan";
  discrete SI.Position goal[2](each start=0, each fixed=true) "Remaining displacement of the escape, world frame";
  discrete SI.Position goal_next[2](each start=0, each fixed=true) "The same after this sample";
  discrete SI.Velocity escape_step[4](each start=0, each fixed=true) "Velocities of a sample of the escape";
  discrete SI.Velocity plan_motion[2](each start=0, each fixed=true)
    "Velocity of the plan, zero while its clock stands still";
  discrete SI.Position plan_error[2](each start=0, each fixed=true)
    "Remaining displacement to the plan at that velocity";
  discrete SI.Distance plan_distance(start=0, fixed=true) "Its length";
  discrete SI.Velocity return_speed(start=0, fixed=true) "Wanted speed of the return";
  discrete SI.Velocity v_wanted[2](each start=0, each fixed=true) "Wanted velocity towards the plan";
  discrete SI.Velocity v_change[2](each start=0, each fixed=true) "Change of velocity towards it";
  discrete Boolean free(start=false, fixed=true) "No correction, no limit: the acceleration is that of the plan";
  discrete SI.Position x[2](each start=0, each fixed=true) "Reference, world frame";
  discrete SI.Angle theta(start=0, fixed=true) "Heading of the reference";
  discrete SI.Velocity v[2](each start=0, each fixed=true) "Velocity of the reference";
  discrete SI.AngularVelocity omega(start=0, fixed=true) "Yaw rate of the reference";
  discrete SI.Acceleration a[2](each start=0, each fixed=true) "Acceleration of the reference";
  discrete SI.AngularAcceleration alpha(start=0, fixed=true) "Yaw acceleration of the reference";
  discrete SI.Position travel[2](each start=0, each fixed=true) "Displacement in this sample, world frame";
  discrete SI.Angle d_theta(start=0, fixed=true) "Rotation in this sample";
  discrete SI.Angle bearing(start=0, fixed=true) "Mean heading of this sample";
  discrete SI.AngularVelocity turned[3](each start=0, each fixed=true) "Mean wheel speeds of this sample";
  discrete SI.Angle q[3](each start=0, each fixed=true) "Wanted wheel angles";
  discrete SI.AngularVelocity w[3](each start=0, each fixed=true) "Wanted wheel speeds";
equation
  path_time = path_ticks*period;
  when sample(0, period) then
    tick = pre(tick) + 1;
    // Sensors and bus: what arrives is one sample old.
    tau = pre(tau_now);
    // A current is that of the time before, as the servos change it at this instant.
    signal = if not motor_current then tau_s else if tick == 0 then tau_start else pre(tau_m);
    tau_now = {resolution*floor(signal[1]/resolution + 0.5), resolution*floor(signal[2]/resolution + 0.5),
      resolution*floor(signal[3]/resolution + 0.5)};
    phi_now = {floor(phi_m[1]/turn*counts)*turn/counts, floor(phi_m[2]/turn*counts)*turn/counts,
      floor(phi_m[3]/turn*counts)*turn/counts};
    // Standstill and tares.
    speed = max(sqrt(pre(v[1])^2 + pre(v[2])^2), abs(pre(omega))*robot.wheel_distance);
    first_tare = pre(mode) == 1 and tare_ticks > 0;
    stop_tare = not pre(stands) and speed <= rest_speed and pre(slow_ticks) + 1 + retare_ticks > rest_ticks;
    tare_low = if pre(tares) == 0 then tau
      else {min(pre(tare_low[1]), tau[1]), min(pre(tare_low[2]), tau[2]), min(pre(tare_low[3]), tau[3])};
    tare_high = if pre(tares) == 0 then tau
      else {max(pre(tare_high[1]), tau[1]), max(pre(tare_high[2]), tau[2]), max(pre(tare_high[3]), tau[3])};
    tare_sum = if pre(tares) == 0 then tau else pre(tare_sum) + tau;
    tare_bad = (first_tare or stop_tare) and max(tare_high - tare_low) > tare_variation;
    tare_done = not tare_bad and (first_tare and pre(tares) + 1 >= tare_ticks or stop_tare and pre(tares)
      + 1 >= retare_ticks);
    tares = if tare_bad or tare_done or not (first_tare or stop_tare) then 0 else pre(tares) + 1;
    zero = if tare_done then tare_sum/(pre(tares) + 1) else pre(zero);
    zero_first = if tare_done and first_tare then zero else pre(zero_first);
    stands = if speed > rest_speed then false else pre(stands) or tare_done and stop_tare;
    slow_ticks = if speed > rest_speed then 0 else if first_tare and tare_done then rest_ticks else pre(slow_ticks) + 1;
    zero_changed = stands <> pre(stands);
    // Estimator: F = J_w^T (T|0 - T_s), (38) and (40).
    v_model = if stands then zeros(2) else Functions.rotate(pre(v), -pre(theta));
    omega_model = if stands then 0 else pre(omega);
    a_model = if stands then zeros(2) else Functions.rotate(pre(a), -pre(theta));
    alpha_model = if stands then 0 else pre(alpha);
    tau_zero = if not stands then pre(zero_first) else if stop_tare then zero else pre(zero);
    F = Functions.nominalForce(v_model, omega_model, a_model, robot.base_mass, m_roll, robot.roller_coulomb_torque,
      robot.roller_tanh_slope, robot.roller_radius)
      + Functions.forceOfTorques(tau_zero - tau, robot.wheel_radius);
    M_z = I_roll*alpha_model + robot.wheel_distance/robot.wheel_radius*sum(tau_zero - tau);
    // Moving average.
    samples = if zero_changed or pre(mode) == 1 then 1 else min(window, pre(samples) + 1);
    past_x = cat(1, {F[1]}, pre(past_x[1:19]));
    past_y = cat(1, {F[2]}, pre(past_y[1:19]));
    mean_sum = if samples == 1 then F else pre(mean_sum) + F
      - (if pre(samples) >= window then {pre(past_x[window]), pre(past_y[window])} else zeros(2));
    mean = sqrt(mean_sum[1]^2 + mean_sum[2]^2)/samples;
    // Detector: the leaky impulse of the force vector, (47) read as an impulse.
    leak = if stands then leak_rest else if speed <= creep_speed then leak_creep else leak_motion;
    lasts = pre(noticed) and not (pre(noticed_ticks) + 1 >= blanking_ticks and (speed < settled_speed or samples > 0
      and mean < release));
    judged = pre(mode) > 1 and not lasts;
    p_sum = if judged then (if zero_changed then zeros(2) else pre(p)) + F*period else zeros(2);
    length = sqrt(p_sum[1]^2 + p_sum[2]^2);
    left = max(0, length - leak*period);
    hit = judged and left > threshold;
    moment_sum = if judged then (if zero_changed then 0 else pre(moment)) + M_z*period else 0;
    hit_arm = if hit then moment_sum/length else pre(hit_arm);
    hit_point = if hit then Functions.outlineEntry(p_sum/length, hit_arm, robot.outline_x, robot.outline_y)
      else pre(hit_point);
    hits = if hit then pre(hits) + 1 else pre(hits);
    hit_tick = if hit then tick else pre(hit_tick);
    // Mode.
    quiet_ticks = if hit or pre(mode) <> 3 then 0 else if speed < settled_speed and mean < leak then pre(quiet_ticks)
      + 1 else 0;
    returned = pre(mode) == 5 and speed < settled_speed
      and sqrt((pre(plan_x[1]) - pre(x[1]))^2 + (pre(plan_x[2]) - pre(x[2]))^2) < rejoin_distance;
    mode = if hit then 3 else if pre(mode) == 1 then (if tare_done or tare_ticks == 0 then 2 else 1) else
      if pre(mode) == 3 and quiet_ticks >= settled_ticks then 4 else if pre(mode) == 4 then 5 else if returned then 2
      else pre(mode);
    noticed = hit or lasts and not (mode <> pre(mode));
    noticed_ticks = if hit then 0 else if pre(noticed) then min(blanking_ticks, pre(noticed_ticks) + 1) else 0;
    moment = if hit or left <= 0 or mode <> pre(mode) then 0 else moment_sum*left/length;
    p = if hit or left <= 0 or mode <> pre(mode) then zeros(2) else p_sum*left/length;
    // Reference: on the plan, escaping, or returning.
    placing = mode == 2 and not pre(placed);
    placed = pre(placed) or placing;
    following = mode == 2 and not placing;
    escaping = mode == 3 or mode == 4;
    returning = mode == 5;
    path_ticks = if mode == 2 then pre(path_ticks) + 1 else pre(path_ticks);
    goal = if hit then escape/length*Functions.rotate(p_sum, pre(theta)) else pre(goal_next);
    escape_step = Functions.escapeStep(goal, pre(v), rate, period, robot.admittance_speed_limit,
      robot.admittance_acceleration_limit, finish_speed);
    plan_motion = if returning then zeros(2) else {pre(plan_v[1]), pre(plan_v[2])};
    plan_error = {pre(plan_x[1]) - pre(x[1]) - period/2*(pre(v[1]) + plan_motion[1]), pre(plan_x[2]) - pre(x[2])
      - period/2*(pre(v[2]) + plan_motion[2])};
    plan_distance = sqrt(plan_error[1]^2 + plan_error[2]^2);
    return_speed = min(min(max(follow*plan_distance, finish_speed),
      Functions.brakingSpeed(plan_acceleration/2, period, plan_distance)), rejoin_speed);
    v_wanted = if returning then return_speed/max(plan_distance, 1e-300)*plan_error
      else Functions.limitLength(plan_motion + follow*plan_error, robot.admittance_speed_limit);
    v_change = Functions.limitLength(v_wanted - pre(v), plan_acceleration*period);
    free = follow*plan_distance <= follow_free and sqrt((v_wanted[1] - pre(v[1]))^2 + (v_wanted[2]
      - pre(v[2]))^2) <= plan_acceleration*period;
    v = if escaping then escape_step[1:2] else if following or returning then pre(v) + v_change else if placing
      and tare_ticks == 0 then {pre(plan_v[1]), pre(plan_v[2])} else zeros(2);
    a = if following and free or placing and tare_ticks == 0 then {pre(plan_a[1]), pre(plan_a[2])} else if placing then
      zeros(2) else (v - pre(v))/period;
    travel = if escaping then escape_step[3:4]*period else if placing then zeros(2) else period/2*(pre(v) + v);
    goal_next = if escaping then goal - travel else zeros(2);
    x = if placing then {pre(plan_x[1]), pre(plan_x[2])} else pre(x) + travel;
    // Wheels; the heading is held throughout (3).
    omega = 0;
    alpha = 0;
    d_theta = 0;
    theta = if placing then pre(plan_theta) else pre(theta) + d_theta;
    bearing = theta - d_theta/2;
    turned = Functions.wheelRates(Functions.rotate(travel, -bearing)/period, d_theta/period, robot.wheel_distance,
      robot.wheel_radius);
    q = (if tick == 0 then pre(phi_now) else pre(q)) + turned*period;
    w = Functions.wheelRates(Functions.rotate(v, -theta), omega, robot.wheel_distance, robot.wheel_radius);
  end when;
  phi_ref = q;
  w_ref = w;
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-90,90},{90,-90}}, lineColor={0,0,127}, fillColor={255,255,255},
        fillPattern=FillPattern.Solid),
      Line(points={{-70,-40},{-40,-40},{-40,0},{-10,0},{-10,40},{20,40},{20,10},{60,10}}, color={0,0,127}),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>The paper's steps of every millisecond, in its order:</p>
<ol>
<li>The torques arrive over the bus, one sample old. With <code>motor_current</code> they are those of the motors, as
their currents show them.</li>
<li>The estimator compares them with T|<sub>0</sub> (38), which is the tare at planned rest, and friction and inertia of
the planned motion otherwise. The difference is the external wrench (40).</li>
<li>The detector integrates the force vector, with a leak F<sub>0</sub> that covers the error of the estimate: s = I + F
T<sub>s</sub>, I = s max(0, 1 &minus; F<sub>0</sub>T<sub>s</sub>/|s|). Above the threshold it is a hit. The moment is
integrated in the same way; moment over force is the lever arm, which locates the hit on the outline (41)-(46).</li>
<li>The admittance moves the reference along the hit's direction by p/B = 0.5 m, (2) and (47), within limits. The
heading is held (3). After half a second at rest without a push it returns to the plan, whose clock has stood still
meanwhile.</li>
<li>The reference becomes wheel angles and speeds, which reach the servos one sample later.</li>
</ol>
<p>This is the controller FMU with the preset \"paper\" (<code>giveway variables controller --preset paper</code>). What
the FMU does with its start values, two channels on measured motion, motors that are observed between two counts, and an
escape that keeps the wheels down, is not in this package.</p>
<p>Left out, as no example needs them: sensor faults, stopping, live force instead of the frozen impulse, and plans that
turn.</p>
</html>"));
end SampledController;
