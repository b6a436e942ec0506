function answer = evaluate (tree, quantities, q, varargin)
  % EVALUATE  Numbers of a tree, e.g. "cell" or "cell@2", for one state or many.
  %
  %   answer = substructures.evaluate ("cell", {"metric", "forces"}, q)
  %   answer = substructures.evaluate ("cell", "bias", q, "qd", qd, "parameters", values)
  %
  % q and qd are 1 x n, or N x n with a row for each state. Further fields as in the HTTP contract, section 4.
  request = struct ('q', {rows(q)});
  request.quantities = quantities;
  for k = 1:2:numel (varargin)
    value = varargin{k + 1};
    if (any (strcmp (varargin{k}, {'qd', 'qdd'})))
      value = rows (value);
    end
    request.(char (varargin{k})) = value;
  end
  answer = substructures.request (['/v1/trees/' char(tree) '/evaluations'], request);
end

function listed = rows (values)
  % a state is a row; of several each is one, so that it stays a list of lists whatever its size
  if (size (values, 1) == 1)
    listed = values;
  else
    listed = num2cell (values, 2);
    listed = cellfun (@num2cell, listed, 'UniformOutput', false);
  end
end
