model Drivetrain
  "The sliding drivetrain of GiveWay.Components.Drivetrain and its load with (28), in the emitter's subset"
  parameter Real tau_m = 1;
  parameter Real direction = 1;
  parameter Real J = 1;
  parameter Real k = 1;
  parameter Real d = 1;
  parameter Real coulomb = 1;
  parameter Real viscous = 1;
  parameter Real limit = 1;
  parameter Real I = 1;
  parameter Real B_r = 1;
  parameter Real slope = 1;
  parameter Real r_r = 1;
  Real phi(start = 0, fixed = true);
  Real w(start = 0, fixed = true);
  Real q(start = 0, fixed = true);
  Real w_w(start = 0, fixed = true);
  Real wind_up;
  Real tau_s;
  Real tau_net;
  Real f;
equation
  wind_up = phi - q;
  tau_s = k*wind_up + d*(w - w_w);
  tau_net = noEvent(max(-limit, min(limit, tau_m))) - tau_s;
  der(phi) = w;
  J*der(w) = tau_net - coulomb*direction - viscous*w;
  der(q) = w_w;
  f = B_r/r_r*tanh(slope*w_w/r_r);
  I*der(w_w) = tau_s - f;
end Drivetrain;
