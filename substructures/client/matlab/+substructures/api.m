classdef api
  % API  A function for each operation of the interface, made of its OpenAPI document.
  %
  %   answer = substructures.api.evaluate_tree ("cell", struct ("quantities", "metric", "q", 0.5))
  %   answer = substructures.api.list_substructures ("tag", "arm", "page_size", 10)
  %
  % What the path names comes first, then the document that is sent (struct () where nothing is to be said), then names
  % and values of the query, or of headers, which begin with a capital ("If-Match", "Prefer").
  methods (Static)
    function answer = evaluate_tree (ref, body, varargin)
      % POST /v1/trees/{ref}/evaluations: Numbers for one state or many: JSON, npz or an Arrow stream by
      % Content-Type, and any of them back by Accept.
      answer = substructures.call ('post', '/v1/trees/{ref}/evaluations', ...
        {ref}, {body}, varargin);
    end

    function answer = submit_substructure (body, varargin)
      % POST /v1/substructures: Derive, verify and store a definition. 201 with the new version, 200 when
      % nothing changed.
      answer = substructures.call ('post', '/v1/substructures', ...
        {}, {body}, varargin);
    end

    function answer = list_substructures (varargin)
      % GET /v1/substructures: A page of the latest versions. Words that are nowhere are taken for the most
      % similar ones, told in `instead`. Query: q, tag, port, source, facets, page_size, page_token,
      % dof_min, dof_max, joints, mass_min, mass_max, owner, sort.
      answer = substructures.call ('get', '/v1/substructures', ...
        {}, {}, varargin);
    end

    function answer = get_substructure (ref, varargin)
      % GET /v1/substructures/{ref}: One version. Aliases and withdrawal may change, so clients revalidate
      % by ETag.
      answer = substructures.call ('get', '/v1/substructures/{ref}', ...
        {ref}, {}, varargin);
    end

    function answer = get_substructure_definition (ref, varargin)
      % GET /v1/substructures/{ref}/definition: The definition as stored.
      answer = substructures.call ('get', '/v1/substructures/{ref}/definition', ...
        {ref}, {}, varargin);
    end

    function answer = withdraw_substructure (ref, body, varargin)
      % POST /v1/substructures/{ref}/withdraw: Withdraw a version: it stays usable by number and digest but
      % is no longer offered as the latest.
      answer = substructures.call ('post', '/v1/substructures/{ref}/withdraw', ...
        {ref}, {body}, varargin);
    end

    function answer = list_aliases (name, varargin)
      % GET /v1/substructures/{name}/aliases: All aliases of a substructure.
      answer = substructures.call ('get', '/v1/substructures/{name}/aliases', ...
        {name}, {}, varargin);
    end

    function answer = get_alias (name, alias, varargin)
      % GET /v1/substructures/{name}/aliases/{alias}: An alias, with the ETag that moving it needs.
      answer = substructures.call ('get', '/v1/substructures/{name}/aliases/{alias}', ...
        {name, alias}, {}, varargin);
    end

    function answer = set_alias (name, alias, body, varargin)
      % PUT /v1/substructures/{name}/aliases/{alias}: Create an alias (201) or move it (200; needs If-Match:
      % 428 without, 412 when it was moved meanwhile).
      answer = substructures.call ('put', '/v1/substructures/{name}/aliases/{alias}', ...
        {name, alias}, {body}, varargin);
    end

    function answer = get_substructure_visibility (name, varargin)
      % GET /v1/substructures/{name}/visibility: Whose a name is, and who sees its versions.
      answer = substructures.call ('get', '/v1/substructures/{name}/visibility', ...
        {name}, {}, varargin);
    end

    function answer = set_substructure_visibility (name, body, varargin)
      % PUT /v1/substructures/{name}/visibility: Let everybody see all versions. What is public stays so
      % (409).
      answer = substructures.call ('put', '/v1/substructures/{name}/visibility', ...
        {name}, {body}, varargin);
    end

    function answer = get_tree_visibility (name, varargin)
      % GET /v1/trees/{name}/visibility: Whose a name is, and who sees its revisions.
      answer = substructures.call ('get', '/v1/trees/{name}/visibility', ...
        {name}, {}, varargin);
    end

    function answer = set_tree_visibility (name, body, varargin)
      % PUT /v1/trees/{name}/visibility: Let everybody see all revisions, whose parts have to be public
      % (409). What is public stays so (409).
      answer = substructures.call ('put', '/v1/trees/{name}/visibility', ...
        {name}, {body}, varargin);
    end

    function answer = list_substructure_versions (name, varargin)
      % GET /v1/substructures/{name}/versions: All versions of a part, the newest first: who made them,
      % when, of what and why; those that are withdrawn, too. Query: page_size, page_token.
      answer = substructures.call ('get', '/v1/substructures/{name}/versions', ...
        {name}, {}, varargin);
    end

    function answer = list_tree_revisions (name, varargin)
      % GET /v1/trees/{name}/revisions: All revisions of a tree, the newest first: who made them, when, of
      % which one and why. Query: page_size, page_token.
      answer = substructures.call ('get', '/v1/trees/{name}/revisions', ...
        {name}, {}, varargin);
    end

    function answer = list_substructure_uses (ref, varargin)
      % GET /v1/substructures/{ref}/uses: Trees with the part, parts that such trees became, parts made from
      % it; of all versions for a bare name. Query: page_size, page_token.
      answer = substructures.call ('get', '/v1/substructures/{ref}/uses', ...
        {ref}, {}, varargin);
    end

    function answer = get_bundle (varargin)
      % GET /v1/bundles: Definitions, programs and certificates of parts as they are stored; the same bytes
      % for the same versions. Query: refs.
      answer = substructures.call ('get', '/v1/bundles', ...
        {}, {}, varargin);
    end

    function answer = get_substructure_difference (ref, varargin)
      % GET /v1/substructures/{ref}/difference: How a version differs from another one, also of another
      % part: fields, formulas entry by entry, and in words. Query: to.
      answer = substructures.call ('get', '/v1/substructures/{ref}/difference', ...
        {ref}, {}, varargin);
    end

    function answer = list_substructure_levels (ref, varargin)
      % GET /v1/substructures/{ref}/levels: The other levels of a version, by what was made from what: full,
      % reduced, abbreviated; with their errors.
      answer = substructures.call ('get', '/v1/substructures/{ref}/levels', ...
        {ref}, {}, varargin);
    end

    function answer = get_tree_difference (ref, varargin)
      % GET /v1/trees/{ref}/difference: How a revision of a tree differs from another one, or from another
      % tree. Query: to.
      answer = substructures.call ('get', '/v1/trees/{ref}/difference', ...
        {ref}, {}, varargin);
    end

    function answer = export_substructure (ref, varargin)
      % GET /v1/substructures/{ref}/export: Functions of the part as it stands alone for a target, on one
      % calling convention. Query: target, quantities, name, bind, together, packed, fmi, precision, ranges,
      % stages, standard, independent.
      answer = substructures.call ('get', '/v1/substructures/{ref}/export', ...
        {ref}, {}, varargin);
    end

    function answer = get_tree_module (ref, varargin)
      % GET /v1/trees/{ref}/program.wasm: Quantities of a tree as a module of WebAssembly. Query:
      % quantities.
      answer = substructures.call ('get', '/v1/trees/{ref}/program.wasm', ...
        {ref}, {}, varargin);
    end

    function answer = get_tree_layout (ref, varargin)
      % GET /v1/trees/{ref}/program.json: What stands where in the memory of `program.wasm`, and how its
      % functions are called. Query: quantities.
      answer = substructures.call ('get', '/v1/trees/{ref}/program.json', ...
        {ref}, {}, varargin);
    end

    function answer = get_tree_origins (ref, varargin)
      % GET /v1/trees/{ref}/origins: The bodies and symbols that every entry of metric, Christoffel symbols
      % and forces comes from.
      answer = substructures.call ('get', '/v1/trees/{ref}/origins', ...
        {ref}, {}, varargin);
    end

    function answer = get_substructure_module (ref, varargin)
      % GET /v1/substructures/{ref}/program.wasm: Quantities of a part, as it stands alone, as a module of
      % WebAssembly. Query: quantities.
      answer = substructures.call ('get', '/v1/substructures/{ref}/program.wasm', ...
        {ref}, {}, varargin);
    end

    function answer = get_substructure_layout (ref, varargin)
      % GET /v1/substructures/{ref}/program.json: What stands where in the memory of `program.wasm`, and how
      % its functions are called. Query: quantities.
      answer = substructures.call ('get', '/v1/substructures/{ref}/program.json', ...
        {ref}, {}, varargin);
    end

    function answer = get_substructure_origins (ref, varargin)
      % GET /v1/substructures/{ref}/origins: The bodies and symbols that every entry of metric, Christoffel
      % symbols and gravity comes from.
      answer = substructures.call ('get', '/v1/substructures/{ref}/origins', ...
        {ref}, {}, varargin);
    end

    function answer = list_substructure_formulas (ref, varargin)
      % GET /v1/substructures/{ref}/formulas: The index of the stored formulas.
      answer = substructures.call ('get', '/v1/substructures/{ref}/formulas', ...
        {ref}, {}, varargin);
    end

    function answer = get_substructure_formula (ref, quantity, varargin)
      % GET /v1/substructures/{ref}/formulas/{quantity}: The formulas of one quantity, all or those of one
      % body, coordinate and component. Query: format, form, bind, name, document, body, coordinate,
      % component, inertia.
      answer = substructures.call ('get', '/v1/substructures/{ref}/formulas/{quantity}', ...
        {ref, quantity}, {}, varargin);
    end

    function answer = get_substructure_picture (ref, varargin)
      % GET /v1/substructures/{ref}/picture: A part alone, in the pose given or at home. Query: q.
      answer = substructures.call ('get', '/v1/substructures/{ref}/picture', ...
        {ref}, {}, varargin);
    end

    function answer = get_tree_picture (ref, varargin)
      % GET /v1/trees/{ref}/picture: A tree, in the pose given or at home. Query: q.
      answer = substructures.call ('get', '/v1/trees/{ref}/picture', ...
        {ref}, {}, varargin);
    end

    function answer = get_substructure_scene (ref, varargin)
      % GET /v1/substructures/{ref}/scene: What there is to draw of a part alone: frames, joints, bodies
      % with their inertia, loads, poses.
      answer = substructures.call ('get', '/v1/substructures/{ref}/scene', ...
        {ref}, {}, varargin);
    end

    function answer = get_tree_scene (ref, varargin)
      % GET /v1/trees/{ref}/scene: What there is to draw of a tree: frames, joints, bodies with their
      % inertia, loads, closures, poses.
      answer = substructures.call ('get', '/v1/trees/{ref}/scene', ...
        {ref}, {}, varargin);
    end

    function answer = get_substructure_report (ref, varargin)
      % GET /v1/substructures/{ref}/report: A part alone, told to people: structure and symmetries of its
      % formulas in words, sizes of terms at the defaults; in LaTeX a document, as XHTML a page, both with
      % picture, symbols, derivation, formulas and sources. Query: format, document.
      answer = substructures.call ('get', '/v1/substructures/{ref}/report', ...
        {ref}, {}, varargin);
    end

    function answer = get_tree_report (ref, varargin)
      % GET /v1/trees/{ref}/report: A tree, told to people, as the report of a part. Query: format,
      % document.
      answer = substructures.call ('get', '/v1/trees/{ref}/report', ...
        {ref}, {}, varargin);
    end

    function answer = create_tree (body, varargin)
      % POST /v1/trees: Couple instances to a tree. 201 with the new revision, 200 when the latest one is
      % the same.
      answer = substructures.call ('post', '/v1/trees', ...
        {}, {body}, varargin);
    end

    function answer = list_trees (varargin)
      % GET /v1/trees: A page of trees, the latest revision of each. Words that are nowhere are taken for
      % the most similar ones. Query: q, uses, page_size, page_token, dof_min, dof_max, joints, mass_min,
      % mass_max, owner, sort.
      answer = substructures.call ('get', '/v1/trees', ...
        {}, {}, varargin);
    end

    function answer = get_tree (ref, varargin)
      % GET /v1/trees/{ref}: A revision of a tree, the latest for a bare name. Its parts may be withdrawn,
      % so clients revalidate by ETag.
      answer = substructures.call ('get', '/v1/trees/{ref}', ...
        {ref}, {}, varargin);
    end

    function answer = remove_tree (ref, varargin)
      % DELETE /v1/trees/{ref}: Remove a tree with all its revisions. Its parts stay, and later revisions of
      % the name count on.
      answer = substructures.call ('delete', '/v1/trees/{ref}', ...
        {ref}, {}, varargin);
    end

    function answer = change_tree (ref, body, varargin)
      % PATCH /v1/trees/{ref}: Give a tree other gravity, parameters, inputs, given motions or momenta,
      % velocity constraints or contacts: a new revision.
      answer = substructures.call ('patch', '/v1/trees/{ref}', ...
        {ref}, {body}, varargin);
    end

    function answer = add_coupling (ref, body, varargin)
      % POST /v1/trees/{ref}/couplings: Couple one more instance onto the tree: a new revision.
      answer = substructures.call ('post', '/v1/trees/{ref}/couplings', ...
        {ref}, {body}, varargin);
    end

    function answer = change_coupling (ref, instance, body, varargin)
      % PATCH /v1/trees/{ref}/couplings/{instance}: Give an instance another part, place or other
      % parameters; what it carries stays on it: a new revision.
      answer = substructures.call ('patch', '/v1/trees/{ref}/couplings/{instance}', ...
        {ref, instance}, {body}, varargin);
    end

    function answer = remove_coupling (ref, instance, varargin)
      % DELETE /v1/trees/{ref}/couplings/{instance}: Remove an instance that carries no other: a new
      % revision.
      answer = substructures.call ('delete', '/v1/trees/{ref}/couplings/{instance}', ...
        {ref, instance}, {}, varargin);
    end

    function answer = add_load (ref, body, varargin)
      % POST /v1/trees/{ref}/loads: Let one more load act between frames of the tree: a new revision.
      answer = substructures.call ('post', '/v1/trees/{ref}/loads', ...
        {ref}, {body}, varargin);
    end

    function answer = remove_load (ref, load, varargin)
      % DELETE /v1/trees/{ref}/loads/{load}: Remove a load of the tree: a new revision.
      answer = substructures.call ('delete', '/v1/trees/{ref}/loads/{load}', ...
        {ref, load}, {}, varargin);
    end

    function answer = add_closure (ref, body, varargin)
      % POST /v1/trees/{ref}/closures: Close one more loop of the tree: a new revision.
      answer = substructures.call ('post', '/v1/trees/{ref}/closures', ...
        {ref}, {body}, varargin);
    end

    function answer = remove_closure (ref, closure, varargin)
      % DELETE /v1/trees/{ref}/closures/{closure}: Cut a loop of the tree open: a new revision.
      answer = substructures.call ('delete', '/v1/trees/{ref}/closures/{closure}', ...
        {ref, closure}, {}, varargin);
    end

    function answer = publish_tree (ref, body, varargin)
      % POST /v1/trees/{ref}/publish: Make a part of a tree, with its ports and free parameters and a
      % certificate of its own.
      answer = substructures.call ('post', '/v1/trees/{ref}/publish', ...
        {ref}, {body}, varargin);
    end

    function answer = compute_abbreviations (ref, body, varargin)
      % POST /v1/trees/{ref}/abbreviations: A quantity with what is negligible over given ranges left out,
      % and a proven bound of the error.
      answer = substructures.call ('post', '/v1/trees/{ref}/abbreviations', ...
        {ref}, {body}, varargin);
    end

    function answer = compute_simulations (ref, body, varargin)
      % POST /v1/trees/{ref}/simulations: The motion from a start, with the drift of all first integrals as
      % judge.
      answer = substructures.call ('post', '/v1/trees/{ref}/simulations', ...
        {ref}, {body}, varargin);
    end

    function answer = compute_ensembles (ref, body, varargin)
      % POST /v1/trees/{ref}/ensembles: Motions from many starts and with many parameters, each with its
      % verdict.
      answer = substructures.call ('post', '/v1/trees/{ref}/ensembles', ...
        {ref}, {body}, varargin);
    end

    function answer = compute_sensitivities (ref, body, varargin)
      % POST /v1/trees/{ref}/sensitivities: A motion and its derivatives by parameters and by the start.
      answer = substructures.call ('post', '/v1/trees/{ref}/sensitivities', ...
        {ref}, {body}, varargin);
    end

    function answer = compute_periodic_orbits (ref, body, varargin)
      % POST /v1/trees/{ref}/periodic-orbits: Motions that come back, with Floquet's multipliers and their
      % stability.
      answer = substructures.call ('post', '/v1/trees/{ref}/periodic-orbits', ...
        {ref}, {body}, varargin);
    end

    function answer = compute_poincare_sections (ref, body, varargin)
      % POST /v1/trees/{ref}/poincare-sections: The states in which a motion crosses a surface in one
      % direction.
      answer = substructures.call ('post', '/v1/trees/{ref}/poincare-sections', ...
        {ref}, {body}, varargin);
    end

    function answer = compute_lyapunov_exponents (ref, body, varargin)
      % POST /v1/trees/{ref}/lyapunov-exponents: How fast neighbouring motions part: whether a motion is
      % chaotic, and how sure.
      answer = substructures.call ('post', '/v1/trees/{ref}/lyapunov-exponents', ...
        {ref}, {body}, varargin);
    end

    function answer = compute_linearisations (ref, body, varargin)
      % POST /v1/trees/{ref}/linearisations: Perturbation equations M, D, K, F and state space A, B, C, D
      % about states; modes and stability at equilibria; of closed loops in independent coordinates, about
      % one state; with velocity constraints about one motion.
      answer = substructures.call ('post', '/v1/trees/{ref}/linearisations', ...
        {ref}, {body}, varargin);
    end

    function answer = compute_frequency_responses (ref, body, varargin)
      % POST /v1/trees/{ref}/frequency-responses: What outputs do where inputs oscillate: G(i w) of a tree
      % linearised about a state, with its poles.
      answer = substructures.call ('post', '/v1/trees/{ref}/frequency-responses', ...
        {ref}, {body}, varargin);
    end

    function answer = compute_regulators (ref, body, varargin)
      % POST /v1/trees/{ref}/regulators: Linear quadratic regulator about an equilibrium, with what inputs
      % reach and weights see.
      answer = substructures.call ('post', '/v1/trees/{ref}/regulators', ...
        {ref}, {body}, varargin);
    end

    function answer = compute_equilibria (ref, body, varargin)
      % POST /v1/trees/{ref}/equilibria: All equilibria that are found, each with its vibrations and
      % stability; also of closed loops.
      answer = substructures.call ('post', '/v1/trees/{ref}/equilibria', ...
        {ref}, {body}, varargin);
    end

    function answer = compute_steady_motions (ref, body, varargin)
      % POST /v1/trees/{ref}/steady-motions: Steady motions: cyclic coordinates at constant rates, all
      % others still; each with its stability and why; families over a parameter, a rate or a momentum with
      % their bifurcations.
      answer = substructures.call ('post', '/v1/trees/{ref}/steady-motions', ...
        {ref}, {body}, varargin);
    end

    function answer = compute_root_loci (ref, body, varargin)
      % POST /v1/trees/{ref}/root-loci: Eigenvalues of an equilibrium over a parameter.
      answer = substructures.call ('post', '/v1/trees/{ref}/root-loci', ...
        {ref}, {body}, varargin);
    end

    function answer = compute_curvatures (ref, body, varargin)
      % POST /v1/trees/{ref}/curvatures: Riemann's tensor of the configuration space, Ricci, scalar.
      answer = substructures.call ('post', '/v1/trees/{ref}/curvatures', ...
        {ref}, {body}, varargin);
    end

    function answer = compute_cost_gradients (ref, body, varargin)
      % POST /v1/trees/{ref}/cost-gradients: The cost of a motion under given controls and its gradient by
      % the adjoint.
      answer = substructures.call ('post', '/v1/trees/{ref}/cost-gradients', ...
        {ref}, {body}, varargin);
    end

    function answer = compute_optimal_controls (ref, body, varargin)
      % POST /v1/trees/{ref}/optimal-controls: Controls of least cost, judged by the necessary conditions.
      answer = substructures.call ('post', '/v1/trees/{ref}/optimal-controls', ...
        {ref}, {body}, varargin);
    end

    function answer = compute_optimal_parameters (ref, body, varargin)
      % POST /v1/trees/{ref}/optimal-parameters: Parameters that make an expression in columns least, within
      % bounds and conditions.
      answer = substructures.call ('post', '/v1/trees/{ref}/optimal-parameters', ...
        {ref}, {body}, varargin);
    end

    function answer = compute_loop_states (ref, body, varargin)
      % POST /v1/trees/{ref}/loop-states: A consistent state of closed loops: mobility, redundancy,
      % accelerations, reaction forces.
      answer = substructures.call ('post', '/v1/trees/{ref}/loop-states', ...
        {ref}, {body}, varargin);
    end

    function answer = compute_reduced_equations (ref, body, varargin)
      % POST /v1/trees/{ref}/reduced-equations: Equations of motion of closed loops in independent
      % coordinates: metric, Christoffel symbols, forces.
      answer = substructures.call ('post', '/v1/trees/{ref}/reduced-equations', ...
        {ref}, {body}, varargin);
    end

    function answer = compute_excitations (ref, body, varargin)
      % POST /v1/trees/{ref}/excitations: How well a motion excites the base inertial parameters.
      answer = substructures.call ('post', '/v1/trees/{ref}/excitations', ...
        {ref}, {body}, varargin);
    end

    function answer = compute_identifications (ref, body, varargin)
      % POST /v1/trees/{ref}/identifications: Base inertial parameters from a measured motion.
      answer = substructures.call ('post', '/v1/trees/{ref}/identifications', ...
        {ref}, {body}, varargin);
    end

    function answer = compute_velocity_equations (ref, body, varargin)
      % POST /v1/trees/{ref}/velocity-equations: Voronets' and Boltzmann-Hamel equations with velocity
      % constraints (rolling, knife edges, closures) as formulas. Query: format, form, bind, name, document.
      answer = substructures.call ('post', '/v1/trees/{ref}/velocity-equations', ...
        {ref}, {body}, varargin);
    end

    function answer = export_tree (ref, varargin)
      % GET /v1/trees/{ref}/export: Functions of the tree for a target: C, MATLAB, Fortran, computer
      % algebra, ..., on one calling convention. Query: target, quantities, name, bind, together, packed,
      % fmi, precision, ranges, stages, standard, independent.
      answer = substructures.call ('get', '/v1/trees/{ref}/export', ...
        {ref}, {}, varargin);
    end

    function answer = get_tree_quantity (ref, quantity, varargin)
      % GET /v1/trees/{ref}/{quantity}: The formulas of a quantity: metric, christoffel, forces, gravity,
      % coriolis, kinematics, regressor, ... Query: group, format, form, bind, name, document, inputs, zero,
      % degree, cyclic, outputs, parameters, quantities, controls, running, terminal, independent, drives,
      % joints.
      answer = substructures.call ('get', '/v1/trees/{ref}/{quantity}', ...
        {ref, quantity}, {}, varargin);
    end

    function answer = compile_tree_kernels (ref, body, varargin)
      % POST /v1/trees/{ref}/kernels: Compile a tree for evaluations of these quantities together. 201 when
      % something was compiled, else 200.
      answer = substructures.call ('post', '/v1/trees/{ref}/kernels', ...
        {ref}, {body}, varargin);
    end

    function answer = submit_job (body, varargin)
      % POST /v1/jobs: Queue a job. 202 when it is on the disk; before that every item has been checked.
      answer = substructures.call ('post', '/v1/jobs', ...
        {}, {body}, varargin);
    end

    function answer = list_jobs (varargin)
      % GET /v1/jobs: A page of jobs, the newest first. Query: state, kind, label, page_size, page_token.
      answer = substructures.call ('get', '/v1/jobs', ...
        {}, {}, varargin);
    end

    function answer = get_job (job, varargin)
      % GET /v1/jobs/{job}: A job with its progress.
      answer = substructures.call ('get', '/v1/jobs/{job}', ...
        {job}, {}, varargin);
    end

    function answer = remove_job (job, varargin)
      % DELETE /v1/jobs/{job}: Remove a job that has ended, with its results and with the states that were
      % uploaded for it alone.
      answer = substructures.call ('delete', '/v1/jobs/{job}', ...
        {job}, {}, varargin);
    end

    function answer = cancel_job (job, body, varargin)
      % POST /v1/jobs/{job}/cancel: Cancel what is not finished; what runs is stopped within two seconds.
      % Others' jobs need the scope admin.
      answer = substructures.call ('post', '/v1/jobs/{job}/cancel', ...
        {job}, {body}, varargin);
    end

    function answer = retry_job (job, body, varargin)
      % POST /v1/jobs/{job}/retry: What of a job failed or was cancelled once more, as a job of its own.
      answer = substructures.call ('post', '/v1/jobs/{job}/retry', ...
        {job}, {body}, varargin);
    end

    function answer = list_job_items (job, varargin)
      % GET /v1/jobs/{job}/items: The items of a job with their states, results and problems. Query: state,
      % page_size, page_token.
      answer = substructures.call ('get', '/v1/jobs/{job}/items', ...
        {job}, {}, varargin);
    end

    function answer = list_job_results (job, varargin)
      % GET /v1/jobs/{job}/result: The items of a job with their states, results and problems. Query: state,
      % page_size, page_token.
      answer = substructures.call ('get', '/v1/jobs/{job}/result', ...
        {job}, {}, varargin);
    end

    function answer = get_job_file (job, position, name, varargin)
      % GET /v1/jobs/{job}/items/{position}/files/{name}: A file of a result.
      answer = substructures.call ('get', '/v1/jobs/{job}/items/{position}/files/{name}', ...
        {job, position, name}, {}, varargin);
    end

    function answer = stream_job_events (job, varargin)
      % GET /v1/jobs/{job}/events: What happened and happens: changes of state, and positions of items that
      % changed. Ends with the job, or with the server: then the client asks again, with ``Last-Event-ID``.
      answer = substructures.call ('get', '/v1/jobs/{job}/events', ...
        {job}, {}, varargin);
    end

    function answer = get_job_archive (job, varargin)
      % GET /v1/jobs/{job}/archive: Everything there is so far as a zip file: ``<position>/item.json`` and
      % the files of the item beside it with the endings of their formats; the formulas of trees and parts
      % that were stored once for all that share them, ``programs/<digest>.json`` by the ``program`` of
      % items.
      answer = substructures.call ('get', '/v1/jobs/{job}/archive', ...
        {job}, {}, varargin);
    end

    function answer = get_job_table (job, varargin)
      % GET /v1/jobs/{job}/table: The rows of a sweep that fit, also while it runs; as JSON in pages, as
      % CSV, npz, Arrow or Parquet all of them. Query: where, sort, columns, page_size, page_token.
      answer = substructures.call ('get', '/v1/jobs/{job}/table', ...
        {job}, {}, varargin);
    end

    function answer = get_job_pareto (job, varargin)
      % GET /v1/jobs/{job}/pareto: The rows of a sweep that no other row beats in all columns of its
      % `pareto`. Query: where, sort, columns, page_size, page_token.
      answer = substructures.call ('get', '/v1/jobs/{job}/pareto', ...
        {job}, {}, varargin);
    end

    function answer = get_job_column (job, column, varargin)
      % GET /v1/jobs/{job}/table/columns/{column}: Mean, deviation, quantiles and histogram of a column.
      % Query: where, bins.
      answer = substructures.call ('get', '/v1/jobs/{job}/table/columns/{column}', ...
        {job, column}, {}, varargin);
    end

    function answer = store_job_row (job, row, body, varargin)
      % POST /v1/jobs/{job}/rows/{row}/tree: Store the tree of a row, coupled and verified as any other.
      answer = substructures.call ('post', '/v1/jobs/{job}/rows/{row}/tree', ...
        {job, row}, {body}, varargin);
    end

    function answer = import_file (body, varargin)
      % POST /v1/imports: Read a robot file as a definition; in a zip with the files that it includes and
      % takes meshes from. 200 with the report; with `store=true` 201 and what was stored. Query: kind,
      % name, file, license, parameters, fixed, base, rotations, cut, preview, store, visibility.
      answer = substructures.call ('post', '/v1/imports', ...
        {}, {body}, varargin);
    end

    function answer = compare_models (body, varargin)
      % POST /v1/equivalences: Compare two models: by formulas, else by numbers; the culprit is named.
      answer = substructures.call ('post', '/v1/equivalences', ...
        {}, {body}, varargin);
    end

    function answer = get_livez (varargin)
      % GET /livez: The process answers; the database is not touched.
      answer = substructures.call ('get', '/livez', ...
        {}, {}, varargin);
    end

    function answer = get_readyz (varargin)
      % GET /readyz: The database answers and takes changes; the catalogue was imported before the server
      % began to listen.
      answer = substructures.call ('get', '/readyz', ...
        {}, {}, varargin);
    end

    function answer = get_metrics (varargin)
      % GET /metrics: Metrics for Prometheus.
      answer = substructures.call ('get', '/metrics', ...
        {}, {}, varargin);
    end

    function answer = get_limits (varargin)
      % GET /v1/limits: Every limit with its value.
      answer = substructures.call ('get', '/v1/limits', ...
        {}, {}, varargin);
    end

    function answer = get_folder (varargin)
      % GET /v1/folder: What was read of the folder that this server follows, and what is refused.
      answer = substructures.call ('get', '/v1/folder', ...
        {}, {}, varargin);
    end

    function answer = list_audit_entries (varargin)
      % GET /v1/audit: A page of acts, the latest first: submissions, aliases, withdrawals, trees, jobs,
      % keys, sessions. Query: owner, key, action, subject, page_size, page_token.
      answer = substructures.call ('get', '/v1/audit', ...
        {}, {}, varargin);
    end
  end
end
