"""Numbers of quantities: states checked, kernels run, limits and conditions held, results with their warnings."""
