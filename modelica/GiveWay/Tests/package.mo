within GiveWay;
package Tests "Models that check themselves"
  extends Modelica.Icons.Package;
  annotation (
    Documentation(info="<html>
<p>Each has a <code>residual</code> that is zero within the solver's tolerance, and asserts it.</p>
</html>"));
end Tests;
