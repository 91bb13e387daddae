module obj_reader
  !! Quadrilateral meshes from Wavefront OBJ text: lines `v x y z` and `f a b c d ...`, where a
  !! vertex may be followed by /texture/normal and be counted backwards (-1 is the last one so far).
  !! Texture coordinates, normals, groups, objects, materials and smoothing groups have no meaning
  !! here and are passed over. Faces of more than four vertices have T-junctions; faces of fewer are
  !! problems.
  use kinds, only: wp
  use extraction_mesh, only: problem_list, whole_number, printable
  use growing_arrays, only: make_room
  use text_scanner, only: scanner_type
  implicit none (type, external)
  private
  public :: read_obj

contains

  subroutine read_obj(text, x, first, vertex, line, problems)
    character(*), intent(in) :: text                     !! the file
    real(wp), allocatable, intent(out) :: x(:,:)         !! vertices (3,nv) [length]
    integer, allocatable, intent(out) :: first(:)        !! vertex of each face in the list (nf+1)
    integer, allocatable, intent(out) :: vertex(:)       !! vertices of the faces
    integer, allocatable, intent(out) :: line(:)         !! of each face in the file (nf)
    type(problem_list), intent(inout) :: problems

    type(scanner_type) :: file
    character(:), allocatable :: word
    real(wp), allocatable :: points(:,:)
    integer :: n, nf, nv
    logical :: found

    allocate (points(3,0), vertex(0), line(0))
    allocate (first(1), source=1)
    n = 0
    nf = 0
    nv = 0
    call file%open(text, '#')
    do
      call file%next_line(found)
      if (.not. found) exit
      call file%next_word(word)
      select case (word)
      case ('v')
        nv = nv + 1
        call make_room(points, nv)
        call read_vertex(file, points(:,nv), problems)
      case ('f')
        nf = nf + 1
        call make_room(line, nf)
        call make_room(first, nf + 1)
        line(nf) = file%line
        call read_face(file, nf, nv, vertex, n, problems)
        first(nf+1) = n + 1
      case ('vt', 'vn', 'vp', 'g', 'o', 's', 'usemtl', 'mtllib', 'l', 'p')
        cycle
      case default
        call problems%add(file%line, 'a line begins with "' // printable(word) // '"', &
          'Meshes are read from the lines v and f of OBJ files')
        if (problems%count > 5) exit
      end select
    end do
    allocate (x(3,nv), source=points(:,1:nv))
    first = first(1:nf+1)
    vertex = vertex(1:n)
    line = line(1:nf)
    if (nf == 0 .and. problems%count == 0) call problems%add(0, 'the file has no faces', &
      'Faces are lines f a b c d')
    if (problems%count > 0) return
    call check_range(first, vertex, nv, line, problems)
  end subroutine read_obj

  subroutine read_vertex(file, x, problems)
    type(scanner_type), intent(inout) :: file
    real(wp), intent(out) :: x(3)
    type(problem_list), intent(inout) :: problems

    real(wp) :: values(7)
    character(:), allocatable :: word
    integer :: n

    ! further numbers are a weight, which only curves of the format have, or colours
    call file%read_rest(values, n, word)
    x = values(1:3)
    if (len(word) > 0) then
      call problems%add(file%line, '"' // printable(word) // '" is no coordinate', &
        'A vertex is v x y z')
    else if (n < 3) then
      call problems%add(file%line, 'a vertex has ' // whole_number(n) // ' coordinates', &
        'A vertex is v x y z')
    else if (any(abs(x) > huge(1.0_wp))) then
      call problems%add(file%line, 'a coordinate is infinite', '')
    end if
  end subroutine read_vertex

  subroutine read_face(file, nf, nv, vertex, n, problems)
    type(scanner_type), intent(inout) :: file
    integer, intent(in) :: nf                            !! number of the face
    integer, intent(in) :: nv                            !! vertices so far
    integer, allocatable, intent(inout) :: vertex(:)     !! vertices of the faces so far
    integer, intent(inout) :: n                          !! in use
    type(problem_list), intent(inout) :: problems

    character(:), allocatable :: word
    integer :: before, code, id, slash

    before = n
    do
      call file%next_word(word)
      if (len(word) == 0) exit
      slash = index(word, '/')
      if (slash == 0) slash = len(word) + 1
      id = 0
      code = 1
      if (slash > 1 .and. slash < 13 .and. verify(word(1:slash-1), '+-0123456789') == 0) &
        read (word(1:slash-1), '(i12)', iostat=code) id
      if (code /= 0 .or. id == 0) then
        call problems%add(file%line, '"' // printable(word) // '" is no vertex of a face', &
          'Vertices are counted from 1, or backwards from -1')
        return
      end if
      if (id < 0) id = nv + 1 + id
      n = n + 1
      call make_room(vertex, n)
      vertex(n) = id
      if (id < 1) then
        call problems%add(file%line, 'a face names a vertex before the first one', '')
        return
      end if
    end do
    if (n - before == 3) then
      call problems%add(file%line, 'face ' // whole_number(nf) // ' is a triangle', &
        'All faces need four corners: subdivide the mesh once (Catmull-Clark), or remesh it')
    else if (n - before < 3) then
      call problems%add(file%line, 'face ' // whole_number(nf) // ' has ' // &
        whole_number(n - before) // ' vertices', 'All faces need four corners')
    end if
  end subroutine read_face

  subroutine check_range(first, vertex, nv, line, problems)
    !! Vertices may follow the faces that name them.
    integer, intent(in) :: first(:), vertex(:), nv, line(:)
    type(problem_list), intent(inout) :: problems

    integer :: f

    do f = 1, size(line)
      associate (face => vertex(first(f):first(f+1)-1))
        if (any(face > nv)) call problems%add(line(f), 'face ' // whole_number(f) // &
          ' names vertex ' // whole_number(maxval(face)) // ', which does not exist', &
          'The file has ' // whole_number(nv) // ' vertices')
      end associate
    end do
  end subroutine check_range
end module obj_reader
