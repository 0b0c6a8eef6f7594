% Draws a motion that Sevenbar exported, in MATLAB or GNU Octave:
%
%     sevenbar export rssr --to mat        writes rssr.mat
%     plot_motion                          draws the output, its velocity and the path of a point
%
% The file has `note` (JSON: units, drive), `columns` (names of the columns of q) and `circuits`, an array of
% structures with a row for each pose: time, status, branch, input, output, q, dq, ddq, dddq, residual and, for
% each named point, point_NAME_position, _velocity and _acceleration. Angles are in radians, lengths in the
% linkage's own unit, or metres after --units si. A value that does not exist is NaN; status gives the reason.
function plot_motion(file)
  if nargin < 1
    file = 'rssr.mat';
  end
  motion = load(file);
  circuits = motion.circuits;
  about = jsondecode(motion.note);
  joints = {about.columns.name};
  slides = strcmp({about.columns.kind}, 'slide');
  in = find(strcmp(joints, about.input));
  out = find(strcmp(joints, about.output));

  figure('Name', about.linkage.name);
  values = subplot(2, 1, 1);
  rates = subplot(2, 1, 2);
  for axes_ = [values, rates]
    hold(axes_, 'on');
    grid(axes_, 'on');
    xlabel(axes_, shown(about, in, slides));
  end
  names = cell(1, numel(circuits));
  for k = 1:numel(circuits)
    circuit = circuits(k);
    plot(values, scaled(circuit.input, slides(in)), scaled(circuit.output, slides(out)));
    plot(rates, scaled(circuit.input, slides(in)), circuit.dq(:, out));
    names{k} = sprintf('circuit %d', circuit.index);
  end
  ylabel(values, shown(about, out, slides));
  if slides(out)
    unit = about.units.length;
  else
    unit = 'rad';
  end
  ylabel(rates, sprintf('%s velocity [%s/s]', about.output, unit));
  legend(values, names);

  points = regexp(fieldnames(circuits), '^point_(.*)_position$', 'tokens', 'once');
  points = [points{:}];
  if ~isempty(points)
    figure('Name', sprintf('path of %s', points{1}));
    hold('on');
    for k = 1:numel(circuits)
      path = circuits(k).(['point_' points{1} '_position']);
      plot3(path(:, 1), path(:, 2), path(:, 3));
    end
    axis('equal');
    grid('on');
    view(3);
    xlabel(sprintf('x [%s]', about.units.length));
    ylabel(sprintf('y [%s]', about.units.length));
    zlabel(sprintf('z [%s]', about.units.length));
  end
end

function text = shown(about, column, slides)
  if slides(column)
    text = sprintf('%s [%s]', about.columns(column).name, about.units.length);
  else
    text = sprintf('%s [deg]', about.columns(column).name);
  end
end

function values = scaled(values, slides)
  if ~slides
    values = values * 180 / pi;
  end
end
