% Calls every exported function file by what the interface document says, and by nothing else.
%
%     generic_caller ("INTERFACE.json", "VALUES.json")
%
% VALUES.json: {"names": [...], "values": [...]}; a parameter that it does not name has its default, all else is 0.
% A line for every output: function, output, then all elements row by row.
function generic_caller (interface, values)
  told = jsondecode (fileread (interface));
  values = jsondecode (fileread (values));
  known = containers.Map (values.names, values.values);
  for each = listed (told.functions)
    f = each{1};
    given = cellfun (@(s) column (chosen (f, told, s), known), listed (f.arguments), "UniformOutput", false);
    outputs = listed (f.outputs);
    found = cell (1, numel (outputs));
    [found{:}] = feval (f.name, given{:});
    for k = 1:numel (outputs)
      shape = outputs{k}.shape(:)';
      full = [shape, ones(1, 2 - numel (shape))];
      if ! isequal (size (found{k}), full)
        error ("caller:shape", "%s has another shape than the document says", f.name);
      end
      turned = permute (found{k}, numel (full):-1:1);
      printf ("%s %s", f.name, outputs{k}.name);
      printf (" %.17g", turned);
      printf ("\n");
    end
  end
end

function cells = listed (some)
  if isstruct (some)
    cells = num2cell (some(:)');
  else
    cells = some(:)';
  end
end

function vector = chosen (f, told, symbol)
  if isfield (f, symbol) && ! isempty (f.(symbol))
    vector = f.(symbol);
  else
    vector = told.vectors.(symbol);
  end
end

function x = column (vector, known)
  x = zeros (vector.length, 1);
  names = cellstr (vector.names);
  for i = 1:vector.length
    if isKey (known, names{i})
      x(i) = known(names{i});
    elseif isfield (vector, "defaults")
      x(i) = vector.defaults(i);
    end
  end
end
