within GiveWay.Functions;
function escapeStep "One sample of the escape (2) within the limits"
  import Modelica.Units.SI;
  extends Modelica.Icons.Function;
  input SI.Position goal[2] "Remaining displacement of the escape, world frame";
  input SI.Velocity v[2] "Velocity, world frame";
  input Real rate(unit="1/s") "Inverse time constant";
  input SI.Time period "Sample period";
  input SI.Velocity speed_limit "Limit of the speed";
  input SI.Acceleration acceleration_limit "Limit of the acceleration";
  input SI.Velocity finish_speed "Lowest speed before the end";
  output SI.Velocity u[4] "Velocity after the sample (1, 2), and mean velocity of the sample (3, 4)";
protected
  SI.Distance left "Remaining distance";
  Real n[2](each unit="1") "Its direction";
  Real decay(unit="1") "Share of the remaining distance that is left after a sample of (2)";
  SI.Velocity mean "Mean speed of a sample of (2)";
  SI.Velocity end_speed "Speed after a sample of (2)";
  SI.Velocity brake "Speed from which half of the deceleration limit stops in time";
  SI.Velocity wanted "Wanted speed";
  SI.Velocity most "Largest change of velocity";
  SI.Velocity change[2] "Change of velocity";
algorithm
  left := sqrt(goal[1]^2 + goal[2]^2);
  n := goal/max(left, 1e-300);
  decay := exp(-rate*period);
  mean := (1 - decay)*left/period;
  end_speed := rate*decay*left;
  brake := brakingSpeed(acceleration_limit/2, period, left - period/2*(v[1]*n[1] + v[2]*n[2]));
  wanted := min(min(max(mean, finish_speed), brake), speed_limit);
  most := acceleration_limit*period;
  if left > 0 and mean >= finish_speed and mean <= min(brake, speed_limit)
    and sqrt((mean*n[1] - v[1])^2 + (mean*n[2] - v[2])^2) <= most
      and sqrt((end_speed*n[1] - v[1])^2 + (end_speed*n[2] - v[2])^2) <= most then
    u := {end_speed*n[1], end_speed*n[2], mean*n[1], mean*n[2]};
  elseif left > 0 and brake <= 0 and sqrt(v[1]^2 + v[2]^2) <= most then
    u := {0, 0, left*n[1]/period, left*n[2]/period};
  else
    change := limitLength({wanted*n[1] - v[1], wanted*n[2] - v[2]}, most);
    u := {v[1] + change[1], v[2] + change[2], v[1] + change[1]/2, v[2] + change[2]/2};
  end if;
  annotation (
    Documentation(info="<html>
<p>(2) and (47) say where the escape ends: x(&infin;) = x<sub>0</sub> + (p/B) u. Written as v = (B/M)(x(&infin;) &minus;
x), speed and acceleration can be limited and the escape still ends there. The paper prints p in N; it is an impulse, in
N s.</p>
</html>"));
end escapeStep;
