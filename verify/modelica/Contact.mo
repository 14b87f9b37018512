model Contact "The forces of GiveWay.Components.DiscContact as rates, in the emitter's subset"
  parameter Real k = 1;
  parameter Real e = 1;
  parameter Real mu = 1;
  parameter Real v_mu = 1;
  parameter Real n_x = 1;
  parameter Real n_y = 1;
  parameter Real p_x = 1;
  parameter Real p_y = 1;
  Real depth(start = 0, fixed = true);
  Real rate(start = 0, fixed = true);
  Real slip(start = 0, fixed = true);
  Real f_normal;
  Real f_friction;
equation
  f_normal = noEvent(if depth > 0 then max(0, k*depth*(1 + e*rate)) else 0);
  f_friction = mu*f_normal*tanh(slip/v_mu);
  der(depth) = -f_normal*n_x + f_friction*n_y;
  der(rate) = -f_normal*n_y - f_friction*n_x;
  der(slip) = -p_x*(f_normal*n_y + f_friction*n_x) + p_y*(f_normal*n_x - f_friction*n_y);
end Contact;
