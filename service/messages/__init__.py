"""What is said between clients and the service: references, pages, formats, answers, refusals, and who asks."""
