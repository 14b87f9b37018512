within GiveWay;
package Tests "Models that check themselves"
  extends Modelica.Icons.Package;
  annotation (
    Documentation(info="<html>
<p>Each has a <code>residual</code> that is zero but for the solver's tolerance, and an assertion of that.</p>
</html>"));
end Tests;
