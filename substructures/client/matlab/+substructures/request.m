function answer = request (path, body)
  % REQUEST  Ask a server of substructures; needs nothing but MATLAB or Octave 7.
  %
  %   answer = substructures.request ("/v1/trees")                 GET
  %   answer = substructures.request ("/v1/trees", document)       POST, a struct, a containers.Map or JSON text
  %
  % The server is that at the address in the environment variable SUBSTRUCTURES_SERVER (http://127.0.0.1:8000), asked
  % with the API key in SUBSTRUCTURES_KEY, if there is one. Lists of one may be sent and come as what stands alone, names
  % with a dot as names with '_'; to send one, use a containers.Map.
  address = getenv ("SUBSTRUCTURES_SERVER");
  if (isempty (address))
    address = "http://127.0.0.1:8000";
  end
  key = getenv ("SUBSTRUCTURES_KEY");
  options = weboptions ("Timeout", 60);
  if (~ isempty (key))
    options = weboptions ("Timeout", 60, "HeaderFields", {"Authorization", ["Bearer " char(key)]});
  end
  url = [char(address) char(path)];
  if (nargin < 2)
    answer = webread (url, options);
  else
    if (~ (ischar (body) || isa (body, "string")))
      body = jsonencode (body);
    end
    answer = webwrite (url, "json", char (body), options);
  end
  if (ischar (answer))  % Octave does not decode
    answer = jsondecode (answer);
  end
end
