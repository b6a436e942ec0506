function answer = request (path, body, method, headers)
  % REQUEST  Ask a server of substructures; needs nothing but MATLAB or Octave 7.
  %
  %   answer = substructures.request ("/v1/trees")                 GET
  %   answer = substructures.request ("/v1/trees", document)       POST, a struct, a containers.Map or JSON text
  %   answer = substructures.request (path, document, "put", {"If-Match", etag})   any method, headers; [] sends nothing
  %
  % The server is that at the address in the environment variable SUBSTRUCTURES_SERVER (http://127.0.0.1:8000), asked
  % with the API key in SUBSTRUCTURES_KEY, if there is one. Lists of one may be sent and come as what stands alone, names
  % with a dot as names with '_'; to send one, use a containers.Map. Formulas, e.g. "/v1/trees/cell/metric?format=text",
  % come as text.
  address = getenv ('SUBSTRUCTURES_SERVER');
  if (isempty (address))
    address = 'http://127.0.0.1:8000';
  end
  key = getenv ('SUBSTRUCTURES_KEY');
  if (nargin < 2)
    body = [];
  end
  if (nargin < 3)
    method = 'auto';
  end
  if (nargin < 4)
    headers = cell (0, 2);
  end
  if (~ isempty (key))
    headers(end + 1, :) = {'Authorization', ['Bearer ' char(key)]};
  end
  if (strcmpi (char (method), 'patch') && exist ('OCTAVE_VERSION', 'builtin'))
    error ('substructures:request', ['Octave sends no PATCH: take curl, or take the instance away and couple ' ...
      'another one (remove_coupling, add_coupling of substructures.api)']);
  end
  options = weboptions ('Timeout', 60, 'RequestMethod', char (method));
  if (~ isempty (headers))
    options.HeaderFields = headers;
  end
  url = [char(address) char(path)];
  try
    if (isnumeric (body) && isempty (body))
      answer = webread (url, options);
    else
      if (~ (ischar (body) || isa (body, 'string')))
        body = jsonencode (body);
      end
      answer = webwrite (url, 'json', char (body), options);
    end
  catch failed
    error ('substructures:request', '%s: %s%s', url, failed.message, advice (failed.message));
  end
  if (ischar (answer) && any (strncmp (strtrim (answer), {'{', '['}, 1)))  % Octave does not decode
    answer = jsondecode (answer);
  end
end

function words = advice (message)
  % what helps against an error of Octave, which keeps what the server says to itself
  words = '';
  if (~ isempty (strfind (message, 'response code said error')))
    words = '; Octave does not show what the server says of it, curl and other clients do';
  elseif (~ isempty (strfind (message, 'connect to server')))
    words = '; start one with ''substructures serve'', or set the variable SUBSTRUCTURES_SERVER to its address';
  end
end
