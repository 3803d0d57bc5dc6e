"""Which specimen under which load: cases, materials, assumptions, the paper's programme, measured files."""
