function answer = call (method, path, names, body, options)
  % CALL  One operation of the interface: what the functions of substructures.api are made of.
  %
  %   answer = substructures.call ("get", "/v1/trees/{ref}", {"cell"}, {}, {})
  %
  % names fill the braces of the path, body is {} or {document}. options are names and values: of the query (text,
  % numbers, true; a cell for several), and of headers, which begin with a capital ("If-Match", "Prefer").
  for k = 1:numel (names)
    path = [path(1:find (path == '{', 1) - 1) escaped(names{k}) path(find (path == '}', 1) + 1:end)];
  end
  headers = cell (0, 2);
  separator = '?';
  for k = 1:2:numel (options)
    name = char (options{k});
    values = options{k + 1};
    if (name(1) ~= lower (name(1)))
      headers(end + 1, :) = {name, char(values)};
      continue
    end
    if (~ iscell (values))
      values = {values};
    end
    for each = values(:)'
      path = [path separator escaped(name) '=' escaped(each{1})];
      separator = '&';
    end
  end
  if (isempty (body))
    body = {[]};
  end
  answer = substructures.request (path, body{1}, method, headers);
end

function text = escaped (value)
  % of a URL
  if (islogical (value))
    words = {'false', 'true'};
    value = words{value + 1};
  elseif (isnumeric (value))
    value = sprintf ('%.17g', value);
  end
  bytes = unicode2native (char (value), 'UTF-8');
  text = '';
  for byte = bytes(:)'
    if (any (byte == 'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-._~@:,'))
      text = [text char(byte)];
    else
      text = [text sprintf('%%%02X', byte)];
    end
  end
end
