within GiveWay.UsersGuide;
class Literature "Sources"
  extends Modelica.Icons.References;
  annotation (
    Documentation(info="<html>
<ul>
<li>K. S. Kim, T. Llado, L. Sentis: Full-body collision detection and reaction with omnidirectional mobile platforms: a
step towards safe human-robot interaction. Autonomous Robots 40 (2016) 325-341.</li>
<li>K. H. Hunt, F. R. E. Crossley: Coefficient of restitution interpreted as damping in vibroimpact. Journal of Applied
Mechanics 42 (1975) 440-445.</li>
<li>C. Canudas de Wit, H. Olsson, K. J. &Aring;str&ouml;m, P. Lischinsky: A new model for control of systems with
friction. IEEE Transactions on Automatic Control 40 (1995) 419-425.</li>
<li>P. Dupont, V. Hayward, B. Armstrong, F. Altpeter: Single state elastoplastic friction models. IEEE Transactions on
Automatic Control 47 (2002) 787-792.</li>
</ul>
</html>"));
end Literature;
