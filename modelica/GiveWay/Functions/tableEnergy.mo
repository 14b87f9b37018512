within GiveWay.Functions;
function tableEnergy "Energy stored by the static column of a table of forces"
  import Modelica.Units.SI;
  extends Modelica.Icons.Function;
  input SI.Position travels[:] "Travels of the rows, rising from 0";
  input SI.Velocity speeds[:] "Speeds of the columns; one is 0";
  input SI.Force forces[:, :] "Forces";
  input SI.Position c "Travel";
  output SI.Energy e "Energy from travel 0";
protected
  Integer j "Column of speed 0";
  SI.Position l "Length of a piece of the way";
  SI.Force f "Force at the end of that piece";
algorithm
  j := 1;
  for k in 1:size(speeds, 1) loop
    if speeds[k] == 0 then
      j := k;
    end if;
  end for;
  e := min(c, 0)*forces[1, j];
  for i in 1:size(travels, 1) - 1 loop
    l := max(0, min(c, travels[i + 1]) - travels[i]);
    f := forces[i, j] + l/(travels[i + 1] - travels[i])*(forces[i + 1, j] - forces[i, j]);
    e := e + l*(forces[i, j] + f)/2;
  end for;
  e := e + max(0, c - travels[size(travels, 1)])*forces[size(travels, 1), j];
  annotation (
    Documentation(info="<html>
<p>The area under the force at speed 0, a trapezium per piece.</p>
</html>"));
end tableEnergy;
