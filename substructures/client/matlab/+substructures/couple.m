function tree = couple (name, instances, varargin)
  % COUPLE  A tree of stored parts; gives it as the server shows it.
  %
  %   arm = struct ("name", "arm", "substructure", "puma560");
  %   hand = struct ("name", "hand", "substructure", "parallel-gripper", "at", "arm.flange");
  %   tree = substructures.couple ("cell", {arm, hand}, "gravity", [0 0 -9.81])
  document = struct ('name', name);
  document.instances = instances;
  for k = 1:2:numel (varargin)
    document.(char (varargin{k})) = varargin{k + 1};
  end
  tree = substructures.request ('/v1/trees', document);
end
