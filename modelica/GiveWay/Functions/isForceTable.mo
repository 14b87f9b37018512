within GiveWay.Functions;
function isForceTable "Is it a table that TableBumper can use?"
  import Modelica.Units.SI;
  extends Modelica.Icons.Function;
  input SI.Position travels[:] "Travels of the rows";
  input SI.Velocity speeds[:] "Speeds of the columns";
  input SI.Force forces[:, :] "Forces";
  output Boolean sound "Travels and speeds rise, a speed is 0, and no force falls with the speed";
protected
  Boolean resting "A speed is 0";
algorithm
  sound := true;
  resting := speeds[1] == 0;
  for i in 2:size(travels, 1) loop
    sound := sound and travels[i] > travels[i - 1];
  end for;
  for j in 2:size(speeds, 1) loop
    sound := sound and speeds[j] > speeds[j - 1];
    resting := resting or speeds[j] == 0;
    for i in 1:size(travels, 1) loop
      sound := sound and forces[i, j] >= forces[i, j - 1];
    end for;
  end for;
  sound := sound and resting;
  annotation (
    Documentation(info="<html>
<p>A force that fell with the speed would give more than it took.</p>
</html>"));
end isForceTable;
